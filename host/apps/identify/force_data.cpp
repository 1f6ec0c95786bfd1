// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/signal_data.hpp"

namespace palpate {
namespace {

/// Resultant of a support or an obstacle on the body.
class ForceData final : public SignalData {
public:
    explicit ForceData(const DataSource& source)
        : SignalData(source, "force_mn", "sd_mn", "mN"),
          table_(source.table),
          component_(read_component(source.table)) {
        const auto on = source.table.text("on");
        if (!on) source.table.missing("on", "the name of a support or an obstacle");
        on_ = *on;
    }

private:
    std::vector<double> series(const SimulationResult& simulation) const override {
        const std::size_t holder = holder_of(simulation);
        std::vector<double> force;
        for (const SimulationState& state : simulation.states)
            force.push_back(state.force_mn[holder][component_]);
        return force;
    }

    std::size_t holder_of(const SimulationResult& simulation) const {
        std::vector<std::string> names;
        for (std::size_t k = 0; k < simulation.num_holders(); ++k) {
            if (simulation.holder_name(k) == on_) return k;
            names.push_back(simulation.holder_name(k));
        }
        table_.refuse("on",
                      fmt::format("allowed: what holds the body: {}", fmt::join(names, ", ")));
    }

    SettingsTable table_;
    std::string on_;
    int component_ = 0;
};

}  // namespace

DataKind force_kind() {
    return {"force", "Force of a support or an obstacle on the body: columns time_s, force_mn",
            signal_keys({"on", "sd_mn"}), [](const DataSource& source) {
                return std::unique_ptr<MeasuredData>(new ForceData(source));
            }};
}

}  // namespace palpate
