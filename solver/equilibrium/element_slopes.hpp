// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "solver/model/solid_model.hpp"

namespace palpate {

/// Numbers of elements, summed by material in the order of the elements: slopes by the parameters
/// of the law, and one by the factor of a viscous step.
class ElementSlopes {
public:
    explicit ElementSlopes(const SolidModel& model) : model_(model) {
        for (const SolidMaterial& material : model.materials)
            width_ = std::max(width_, 1 + material.parameters.size());
        parts_.assign(width_ * model.mesh.region.size(), 0.0);
    }
    std::span<double> parameters_of(Index element) {
        return {&parts_[width_ * element + 1],
                model_.materials[model_.mesh.region[element]].parameters.size()};
    }
    double& factor_of(Index element) { return parts_[width_ * element]; }

    std::vector<std::vector<double>> parameters() const {
        std::vector<std::vector<double>> sums;
        for (const SolidMaterial& material : model_.materials)
            sums.emplace_back(material.parameters.size(), 0.0);
        for (Index e = 0; e < model_.mesh.num_elements(); ++e) {
            std::vector<double>& of_material = sums[model_.mesh.region[e]];
            for (std::size_t k = 0; k < of_material.size(); ++k)
                of_material[k] += parts_[width_ * e + 1 + k];
        }
        return sums;
    }
    std::vector<double> factor() const {
        std::vector<double> sums(model_.materials.size());
        for (Index e = 0; e < model_.mesh.num_elements(); ++e)
            sums[model_.mesh.region[e]] += parts_[width_ * e];
        return sums;
    }

private:
    const SolidModel& model_;
    std::size_t width_ = 1;
    std::vector<double> parts_;
};

}  // namespace palpate
