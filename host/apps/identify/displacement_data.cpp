// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/mesh_probe.hpp"
#include "host/apps/identify/signal_data.hpp"
#include "host/apps/simulate/setting_values.hpp"

namespace palpate {
namespace {

/// How far one place of the body moved.
class DisplacementData final : public SignalData {
public:
    explicit DisplacementData(const DataSource& source)
        : SignalData(source, "displacement_mm", "sd_mm", "mm"),
          table_(source.table),
          place_(needed_vector(source.table, "at_mm")),
          component_(read_component(source.table)) {}

private:
    std::vector<double> series(const SimulationResult& simulation) const override {
        const auto found = MeshProbe(simulation.mesh()).find(place_);
        if (!found) table_.refuse("at_mm", "allowed: a place in the body at rest");
        std::vector<double> moved;
        for (const SimulationState& state : simulation.states)
            moved.push_back(found->displacement(state.displacement)[component_]);
        return moved;
    }

    SettingsTable table_;
    Vec3 place_;
    int component_ = 0;
};

}  // namespace

DataKind displacement_kind() {
    return {"displacement", "How far one place of the body moved: columns time_s, displacement_mm",
            signal_keys({"at_mm", "sd_mm"}), [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new DisplacementData(source));
            }};
}

}  // namespace palpate
