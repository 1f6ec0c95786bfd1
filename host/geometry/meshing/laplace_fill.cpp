// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/laplace_fill.hpp"

#include <algorithm>
#include <cmath>

#include "solver/base/parallel.hpp"

namespace palpate {
namespace {

using Value = Eigen::Array3f;

/// Unknown cells first <= i < end of one row.
struct Run {
    Index j = 0, k = 0, first = 0, end = 0;
};

/// Cell-centred grid of one level. Known cells hold Dirichlet values, unknown ones the solution.
struct Level {
    std::array<Index, 3> size{};
    std::array<float, 3> weight{};         ///< 1 / h^2 per axis
    std::array<Index, 3> factor{1, 1, 1};  ///< 2 along the axes that this level halved
    std::vector<std::uint8_t> unknown;
    std::vector<Run> runs;  ///< all unknown cells
    std::size_t num_unknown = 0;
    std::vector<Value> value, source;  ///< Laplacian(value) = source at unknown cells

    std::size_t row(Index j, Index k) const {
        return std::size_t(size[0]) * (std::size_t(j) + std::size_t(size[1]) * k);
    }
    Index num_rows() const { return size[1] * size[2]; }
};

void find_runs(Level& level) {
    for (Index r = 0; r < level.num_rows(); ++r) {
        const Index j = r % level.size[1], k = r / level.size[1];
        const auto* begin = level.unknown.data() + level.row(j, k);
        const auto* end = begin + level.size[0];
        for (const auto* first = std::find(begin, end, 1); first != end;) {
            const auto* last = std::find(first, end, 0);
            level.runs.push_back({j, k, Index(first - begin), Index(last - begin)});
            level.num_unknown += std::size_t(last - first);
            first = std::find(last, end, 1);
        }
    }
}

/// Calls body(first, end) for pieces of the level's runs, on all cores where that pays.
template <typename Body>
void for_runs(const Level& level, const Body& body) {
    constexpr std::size_t worth_threads = 200000;  // cells
    if (level.num_unknown < worth_threads) {
        body(std::size_t(0), level.runs.size());
    } else {
        parallel_ranges(level.runs.size(), 1, body);
    }
}

/// Weighted sum of the neighbours of one cell and the sum of their weights; neighbours beyond the
/// border are left out, which is the zero normal derivative.
struct Stencil {
    const Level& level;
    std::array<std::size_t, 3> stride;

    explicit Stencil(const Level& l)
        : level(l), stride{1, std::size_t(l.size[0]), std::size_t(l.size[0]) * l.size[1]} {}

    Value neighbours(Index i, Index j, Index k, std::size_t at, float& total) const {
        Value sum = Value::Zero();
        total = 0;
        const std::array<Index, 3> index{i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
            const float w = level.weight[axis];
            if (index[axis] > 0) {
                sum += w * level.value[at - stride[axis]];
                total += w;
            }
            if (index[axis] + 1 < level.size[axis]) {
                sum += w * level.value[at + stride[axis]];
                total += w;
            }
        }
        return sum;
    }
};

/// One Gauss-Seidel pass over the cells with (i + j + k) % 2 == colour; returns the largest change.
float relax_colour(Level& level, Index colour) {
    const Stencil stencil(level);
    std::vector<float> change(level.runs.size(), 0.0f);
    for_runs(level, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
            const auto [j, k, first, last] = level.runs[r];
            const std::size_t row = level.row(j, k);
            for (Index i = first + ((first + j + k + colour) & 1); i < last; i += 2) {
                float total;
                const Value sum = stencil.neighbours(i, j, k, row + i, total);
                if (total == 0) continue;
                const Value next = (sum - level.source[row + i]) / total;
                change[r] = std::max(change[r], (next - level.value[row + i]).abs().maxCoeff());
                level.value[row + i] = next;
            }
        }
    });
    return change.empty() ? 0.0f : *std::max_element(change.begin(), change.end());
}

float relax(Level& level, int passes) {
    float change = 0;
    for (int pass = 0; pass < passes; ++pass) {
        change = relax_colour(level, 0);
        change = std::max(change, relax_colour(level, 1));
    }
    return change;
}

/// Axes whose spacing is close to the smallest are halved, so that cells become cubes first.
Level coarsen(const Level& fine) {
    Level coarse;
    const float largest = std::max({fine.weight[0], fine.weight[1], fine.weight[2]});
    for (int axis = 0; axis < 3; ++axis) {
        const bool halve = fine.weight[axis] > 0.45f * largest && fine.size[axis] > 1;
        coarse.factor[axis] = halve ? 2 : 1;
        coarse.size[axis] = halve ? (fine.size[axis] + 1) / 2 : fine.size[axis];
        coarse.weight[axis] = halve ? 0.25f * fine.weight[axis] : fine.weight[axis];
        if (fine.size[axis] == 1) coarse.weight[axis] *= 0.25f;  // a flat axis has no neighbours
    }
    return coarse;
}

template <typename Visit>
void for_children(const Level& fine, const Level& coarse, Index i, Index j, Index k,
                  const Visit& visit) {
    const auto [fi, fj, fk] = coarse.factor;
    for (Index c = k * fk; c < std::min((k + 1) * fk, fine.size[2]); ++c) {
        for (Index b = j * fj; b < std::min((j + 1) * fj, fine.size[1]); ++b) {
            const std::size_t row = fine.row(b, c);
            for (Index a = i * fi; a < std::min((i + 1) * fi, fine.size[0]); ++a) visit(row + a);
        }
    }
}

/// A coarse cell is known if one of its children is: its value is their mean.
Level coarse_level(const Level& fine) {
    Level coarse = coarsen(fine);
    const std::size_t num_cells = std::size_t(coarse.num_rows()) * coarse.size[0];
    coarse.unknown.assign(num_cells, 1);
    coarse.value.assign(num_cells, Value::Zero());
    coarse.source.assign(num_cells, Value::Zero());
    parallel_ranges(coarse.num_rows(), 1, [&](Index begin, Index end) {
        for (Index r = begin; r < end; ++r) {
            const Index j = r % coarse.size[1], k = r / coarse.size[1];
            for (Index i = 0; i < coarse.size[0]; ++i) {
                Value sum = Value::Zero();
                int count = 0;
                for_children(fine, coarse, i, j, k, [&](std::size_t at) {
                    if (fine.unknown[at]) return;
                    sum += fine.value[at];
                    ++count;
                });
                if (count == 0) continue;
                coarse.unknown[coarse.row(j, k) + i] = 0;
                coarse.value[coarse.row(j, k) + i] = sum / float(count);
            }
        }
    });
    find_runs(coarse);
    return coarse;
}

/// Puts the mean residual of the children into `source` and starts the correction from zero: a
/// known cell has no error.
void restrict_residual(const Level& fine, Level& coarse) {
    const Stencil stencil(fine);
    std::fill(coarse.value.begin(), coarse.value.end(), Value::Zero());
    for_runs(coarse, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
            const auto [j, k, first, last] = coarse.runs[r];
            for (Index i = first; i < last; ++i) {
                Value sum = Value::Zero();
                int count = 0;
                for_children(fine, coarse, i, j, k, [&](std::size_t at) {
                    const Index c = Index(at / stencil.stride[2]);
                    const Index b = Index(at % stencil.stride[2] / stencil.stride[1]);
                    const Index a = Index(at % stencil.stride[1]);
                    float total;
                    const Value near = stencil.neighbours(a, b, c, at, total);
                    sum += fine.source[at] - (near - total * fine.value[at]);
                    ++count;
                });
                coarse.source[coarse.row(j, k) + i] = sum / float(count);
            }
        }
    });
}

/// Linear interpolation between cell centres, clamped at the border.
Value interpolate(const Level& coarse, std::array<Index, 3> cell) {
    std::array<Index, 3> low{}, high{};
    std::array<float, 3> t{};
    for (int axis = 0; axis < 3; ++axis) {
        const float x =
            coarse.factor[axis] == 2 ? 0.5f * float(cell[axis]) - 0.25f : float(cell[axis]);
        const Index below = static_cast<Index>(std::floor(x));
        t[axis] = x - float(below);
        low[axis] = std::clamp<Index>(below, 0, coarse.size[axis] - 1);
        high[axis] = std::clamp<Index>(below + 1, 0, coarse.size[axis] - 1);
    }
    const auto along_i = [&](Index j, Index k) -> Value {
        const std::size_t row = coarse.row(j, k);
        return (1 - t[0]) * coarse.value[row + low[0]] + t[0] * coarse.value[row + high[0]];
    };
    const Value front = (1 - t[1]) * along_i(low[1], low[2]) + t[1] * along_i(high[1], low[2]);
    const Value back = (1 - t[1]) * along_i(low[1], high[2]) + t[1] * along_i(high[1], high[2]);
    return (1 - t[2]) * front + t[2] * back;
}

/// value = keep * value + (the coarse level interpolated) at the unknown cells.
void prolongate(const Level& coarse, Level& fine, float keep) {
    for_runs(fine, [&](std::size_t begin, std::size_t end) {
        for (std::size_t r = begin; r < end; ++r) {
            const auto [j, k, first, last] = fine.runs[r];
            const std::size_t row = fine.row(j, k);
            for (Index i = first; i < last; ++i) {
                fine.value[row + i] = keep * fine.value[row + i] + interpolate(coarse, {i, j, k});
            }
        }
    });
}

/// One V-cycle; returns the largest change in its last pass.
float cycle(std::vector<Level>& levels, std::size_t at) {
    if (at + 1 == levels.size()) return relax(levels[at], 30);
    relax(levels[at], 2);
    restrict_residual(levels[at], levels[at + 1]);
    cycle(levels, at + 1);
    prolongate(levels[at + 1], levels[at], 1.0f);
    return relax(levels[at], 2);
}

Level finest_level(const Image<Vec3>& image, const std::vector<std::uint8_t>& unknown) {
    Level level;
    level.size = image.grid.size;
    const double finest = image.grid.spacing.minCoeff();
    for (int axis = 0; axis < 3; ++axis) {
        level.weight[axis] = float(std::pow(finest / image.grid.spacing[axis], 2));
    }
    level.unknown = unknown;
    level.value.resize(unknown.size());
    level.source.assign(unknown.size(), Value::Zero());
    for (std::size_t v = 0; v < unknown.size(); ++v) {
        level.value[v] = unknown[v] ? Value::Zero() : Value(image.voxels[v].cast<float>());
    }
    find_runs(level);
    return level;
}

}  // namespace

void laplace_fill(Image<Vec3>& image, const std::vector<std::uint8_t>& unknown, double tolerance) {
    constexpr int max_cycles = 12;
    if (std::find(unknown.begin(), unknown.end(), 1) == unknown.end()) return;
    if (std::find(unknown.begin(), unknown.end(), 0) == unknown.end()) {
        std::fill(image.voxels.begin(), image.voxels.end(), Vec3::Zero().eval());
        return;
    }

    std::vector<Level> levels;
    levels.push_back(finest_level(image, unknown));
    while (levels.back().num_unknown > 0 &&
           *std::max_element(levels.back().size.begin(), levels.back().size.end()) > 2) {
        levels.push_back(coarse_level(levels.back()));
    }

    // From the coarsest level up: interpolate the coarse solution, then improve it by one cycle.
    // The cycles use the coarser levels for corrections, so each coarse solution is read once.
    relax(levels.back(), 30);
    for (std::size_t at = levels.size() - 1; at-- > 0;) {
        prolongate(levels[at + 1], levels[at], 0.0f);
        cycle(levels, at);
    }
    for (int n = 0; n < max_cycles && cycle(levels, 0) > tolerance; ++n) {
    }

    for (std::size_t v = 0; v < unknown.size(); ++v) {
        if (unknown[v]) image.voxels[v] = levels[0].value[v].matrix().cast<double>();
    }
}

}  // namespace palpate
