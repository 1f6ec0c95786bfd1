// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/guess_transfer.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace palpate {
namespace {

/// How many cells of the other mesh stand where two of this one do; empty: the meshes have nothing
/// to do with each other.
std::optional<int> cells_for_two(const MeshSettings& other, const MeshSettings& own) {
    if (other.file != own.file || other.graded.has_value() != own.graded.has_value())
        return std::nullopt;
    if (!own.graded)
        return other.grid.divisions == own.grid.divisions ? std::optional(2) : std::nullopt;
    const auto cells = [](const GradedSettings& one) {
        return std::array{one.columns_inside, one.columns_edge, one.columns_outside, one.rows};
    };
    if (cells(*other.graded) != cells(*own.graded)) return std::nullopt;
    const int finer = other.graded->refine * own.graded->coarsen,
              coarser = own.graded->refine * other.graded->coarsen;
    if (finer == 2 * coarser) return 4;
    if (finer == coarser) return 2;
    if (2 * finer == coarser) return 1;
    return std::nullopt;
}

/// u on a graded mesh, which has its nodes line by line, `columns` in each.
class LinesOfNodes {
public:
    LinesOfNodes(const SolidMesh& mesh, const Eigen::VectorXd& u)
        : columns_(mesh.elements[0] - mesh.elements[3]),
          rows_(mesh.num_nodes() / columns_),
          u_(u) {}

    Eigen::VectorXd on_half_cells() const {
        const Index columns = 2 * columns_ - 1, rows = 2 * rows_ - 1;
        Eigen::VectorXd finer(3 * columns * rows);
        for (Index j = 0; j < rows; ++j)
            for (Index i = 0; i < columns; ++i)
                // on a line of the coarser mesh both are the same line
                finer.segment<3>(3 * (columns * j + i)) =
                    0.25 * (at(i / 2, j / 2) + at((i + 1) / 2, j / 2) + at(i / 2, (j + 1) / 2) +
                            at((i + 1) / 2, (j + 1) / 2));
        return finer;
    }
    Eigen::VectorXd on_double_cells() const {
        const Index columns = (columns_ + 1) / 2, rows = (rows_ + 1) / 2;
        Eigen::VectorXd coarser(3 * columns * rows);
        for (Index j = 0; j < rows; ++j)
            for (Index i = 0; i < columns; ++i)
                coarser.segment<3>(3 * (columns * j + i)) = at(2 * i, 2 * j);
        return coarser;
    }

private:
    Vec3 at(Index i, Index j) const { return u_.segment<3>(3 * (columns_ * j + i)); }

    Index columns_, rows_;
    const Eigen::VectorXd& u_;
};

/// u at a time between those of the states, or at the last.
Eigen::VectorXd at_time(const SimulationResult& from, const std::vector<Eigen::VectorXd>& u,
                        double time_s) {
    const auto& states = from.states;
    const auto after =
        std::lower_bound(states.begin(), states.end(), time_s,
                         [](const SimulationState& one, double t) { return one.time_s < t; });
    if (after == states.end()) return u.back();
    const auto k = std::size_t(after - states.begin());
    if (k == 0 || states[k].time_s == time_s) return u[k];
    const double before_s = states[k - 1].time_s;
    const double share = (time_s - before_s) / (states[k].time_s - before_s);
    return u[k - 1] + share * (u[k] - u[k - 1]);
}

}  // namespace

std::vector<Eigen::VectorXd> transferred_guesses(const SimulationSettings& settings,
                                                 const SimulationResult& from,
                                                 const std::vector<Eigen::VectorXd>& displacement) {
    const std::optional<int> cells = cells_for_two(settings.mesh, from.settings.mesh);
    if (!cells || settings.history.has_value() != from.settings.history.has_value()) return {};
    std::vector<Eigen::VectorXd> guesses(displacement.begin() + 1, displacement.end());
    if (settings.history && settings.history->time_s != from.settings.history->time_s) {
        guesses.clear();
        for (const double time_s : settings.history->time_s)
            guesses.push_back(at_time(from, displacement, time_s));
    }
    if (*cells == 2) return guesses;
    for (Eigen::VectorXd& guess : guesses) {
        const LinesOfNodes lines(from.mesh(), guess);
        guess = *cells == 4 ? lines.on_half_cells() : lines.on_double_cells();
    }
    return guesses;
}

}  // namespace palpate
