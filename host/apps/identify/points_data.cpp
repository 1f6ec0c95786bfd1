// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "host/apps/identify/data_kinds.hpp"
#include "host/apps/identify/mesh_probe.hpp"
#include "host/apps/identify/signal_data.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// How far marked places of the body moved, at one time or several. Rows are all x, then all y,
/// then all z, as far as the file has them.
class PointsData final : public MeasuredData {
public:
    explicit PointsData(const DataSource& source)
        : numbers_(source.numbers), times_(source.numbers) {
        read_places();
        const Eigen::VectorXd sd = read_sd(source, "sd_mm");
        std::vector<double> measured;
        for (int c = 0; c < 3; ++c) {
            const std::string column = std::string("u") + "xyz"[c] + "_mm";
            if (!numbers_.find(column)) continue;
            components_.push_back(c);
            for (const double value : numbers_.values(column)) measured.push_back(value);
        }
        if (components_.empty()) numbers_.values("ux_mm");  // which says what is missing
        block_.unit = "mm";
        block_.measured = vector_of(measured);
        const Eigen::Index parts = Eigen::Index(components_.size());
        block_.sd = sd.replicate(parts, 1);
        block_.position_mm = position_.replicate(parts, 1);
        if (times_.are_given()) block_.time_s = vector_of(times_.time_s()).replicate(parts, 1);
    }

    Eigen::VectorXd predicted(const ExperimentState& state) const override {
        const MeshProbe probe(state.simulation->mesh());
        Eigen::VectorXd rows(block_.num_row());
        const Eigen::Index count = position_.rows();
        for (Eigen::Index row = 0; row < count; ++row) {
            const auto place = probe.find(position_.row(row).transpose());
            if (!place)
                throw Error(ErrorCode::invalid_argument,
                            fmt::format("{}, line {}: the place is not in the body at rest",
                                        numbers_.source, numbers_.lines[row]));
            const Vec3 moved = displacement_at(*state.simulation, *place, std::size_t(row));
            for (std::size_t k = 0; k < components_.size(); ++k)
                rows[Eigen::Index(k) * count + row] = moved[components_[k]];
        }
        return rows;
    }

private:
    void read_places() {
        position_ = Eigen::MatrixXd::Zero(Eigen::Index(numbers_.rows.size()), 3);
        position_.col(0) = vector_of(numbers_.values("x_mm"));
        position_.col(1) = vector_of(numbers_.values("y_mm"));
        if (numbers_.find("z_mm")) position_.col(2) = vector_of(numbers_.values("z_mm"));
    }

    Vec3 displacement_at(const SimulationResult& simulation, const ProbedPlace& place,
                         std::size_t row) const {
        const auto [before, after, share] = times_.at(simulation, row, 0);
        const Vec3 first = place.displacement(simulation.states[before].displacement);
        return first + share * (place.displacement(simulation.states[after].displacement) - first);
    }

    NumberTable numbers_;
    MeasuredTimes times_;
    Eigen::MatrixXd position_;  ///< [places, 3] mm
    std::vector<int> components_;
};

}  // namespace

DataKind points_kind() {
    return {
        "points",
        "How far marked places moved: columns x_mm, y_mm, z_mm of the place at rest, and ux_mm, "
        "uy_mm, uz_mm, or some of these; time_s",
        {"sd_mm"},
        [](const DataSource& source) {
            return std::unique_ptr<MeasuredData>(new PointsData(source));
        }};
}

}  // namespace palpate
