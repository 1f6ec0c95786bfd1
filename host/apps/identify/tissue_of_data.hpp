// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "host/apps/simulate/simulation_settings.hpp"

namespace palpate {

/// Moduli of a sudden strain are 1 + sum C times those of long times.
inline double long_term_part(const SolidMaterial& material) {
    double sum = 1;
    if (material.is_instantaneous)
        for (const RelaxationTerm& term : material.relaxation) sum += term.amplitude;
    return 1 / sum;
}

/// The [[material]] that data are of: `material = 2` is its region; the only one if not given.
class TissueOfData {
public:
    explicit TissueOfData(const SettingsTable& table)
        : table_(table), region_(table.whole_number("material", 0, 65535)) {}

    /// Throws Error(invalid_argument) if there is none, or several and none is meant.
    const SolidMaterial& material_in(const std::vector<MaterialSettings>& materials) const {
        for (const MaterialSettings& one : materials)
            if (region_ ? one.region == *region_ : materials.size() == 1) return one.material;
        if (region_) table_.refuse("material", "allowed: the region of a [[material]]");
        table_.missing("material", "the region of a [[material]], because there are several");
    }

private:
    SettingsTable table_;
    std::optional<int> region_;
};

}  // namespace palpate
