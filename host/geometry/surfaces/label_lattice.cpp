// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/label_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "host/geometry/surfaces/interfaces.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

// 1 where every voxel within the reach of the field's smoothing has the same label: there the
// field need not be asked.
std::vector<std::uint8_t> uniform_voxels(const RegionImage& image, double reach_mm) {
    const auto& size = image.grid.size;
    std::vector<std::uint8_t> low = image.voxels, high = image.voxels;
    const std::array<std::size_t, 3> stride{1, std::size_t(size[0]),
                                            std::size_t(size[0]) * std::size_t(size[1])};
    std::vector<std::uint8_t> line_low, line_high;
    for (int axis = 0; axis < 3; ++axis) {
        const Index n = size[axis];
        const Index reach =
            std::min<Index>(n, Index(std::ceil(reach_mm / image.grid.spacing[axis])));
        line_low.resize(n), line_high.resize(n);
        for (std::size_t start = 0; start < low.size(); ++start) {
            if ((start / stride[axis]) % std::size_t(n) != 0) continue;
            for (Index i = 0; i < n; ++i) {
                line_low[i] = low[start + i * stride[axis]];
                line_high[i] = high[start + i * stride[axis]];
            }
            for (Index i = 0; i < n; ++i) {
                const Index first = std::max<Index>(0, i - reach),
                            last = std::min(n, i + reach + 1);
                low[start + i * stride[axis]] =
                    *std::min_element(line_low.begin() + first, line_low.begin() + last);
                high[start + i * stride[axis]] =
                    *std::max_element(line_high.begin() + first, line_high.begin() + last);
            }
        }
    }
    for (std::size_t i = 0; i < low.size(); ++i) low[i] = low[i] == high[i];
    return low;
}

// Whether the cells of a 2 x 2 x 2 block whose bits are set hang together through faces.
bool is_connected(unsigned mask) {
    if (mask == 0) return true;
    unsigned reached = mask & (~mask + 1u);
    for (int round = 0; round < 8; ++round)
        for (unsigned cell = 0; cell < 8; ++cell)
            if (reached >> cell & 1u)
                for (unsigned axis = 0; axis < 3; ++axis)
                    reached |= (1u << (cell ^ (1u << axis))) & mask;
    return reached == mask;
}

std::array<bool, 256> manifold_blocks() {
    std::array<bool, 256> table{};
    for (unsigned mask = 0; mask < 256; ++mask)
        table[mask] = is_connected(mask) && is_connected(~mask & 255u);
    return table;
}

using Block = std::array<std::uint8_t, 8>;

// The eight cells round a lattice corner; cell b lies at (i-1, j-1, k-1) plus the bits of b.
Block block_at(const LabelLattice& lattice, Index i, Index j, Index k) {
    Block block;
    for (int b = 0; b < 8; ++b)
        block[b] = lattice.at(i - 1 + (b & 1), j - 1 + (b >> 1 & 1), k - 1 + (b >> 2));
    return block;
}

bool is_manifold(const Block& block) {
    static const std::array<bool, 256> table = manifold_blocks();
    for (int first = 0; first < 8; ++first) {
        unsigned mask = 0;
        for (int b = 0; b < 8; ++b) mask |= unsigned(block[b] == block[first]) << b;
        if (!table[mask]) return false;
    }
    return true;
}

int bad_blocks_around(const LabelLattice& lattice, Index i, Index j, Index k) {
    int bad = 0;
    for (int b = 0; b < 8; ++b)
        bad += !is_manifold(block_at(lattice, i + (b & 1), j + (b >> 1 & 1), k + (b >> 2)));
    return bad;
}

struct Switch {
    std::size_t cell = 0;
    std::uint8_t label = beyond_box;
    int gain = std::numeric_limits<int>::min();  ///< bad blocks that it removes
    double cost = std::numeric_limits<double>::infinity();
};

// The switch of one cell of the block at corner (i, j, k) that removes most bad blocks; among
// equals the one where the field objects least.
Switch best_switch(LabelLattice& lattice, const Interfaces& interfaces, Index i, Index j, Index k) {
    const Block block = block_at(lattice, i, j, k);
    Switch best;
    for (int b = 0; b < 8; ++b) {
        const Index ci = i - 1 + (b & 1), cj = j - 1 + (b >> 1 & 1), ck = k - 1 + (b >> 2);
        if (block[b] == beyond_box) continue;
        const int before = bad_blocks_around(lattice, ci, cj, ck);
        Block candidates = block;
        std::sort(candidates.begin(), candidates.end());
        const auto end = std::unique(candidates.begin(), candidates.end());
        for (auto label = candidates.begin(); label != end; ++label) {
            if (*label == block[b] || *label == beyond_box) continue;
            const std::size_t cell = lattice.offset(ci, cj, ck);
            lattice.labels[cell] = *label;
            const int gain = before - bad_blocks_around(lattice, ci, cj, ck);
            lattice.labels[cell] = block[b];
            const Vec3 centre = lattice.centre(ci, cj, ck);
            const double cost =
                interfaces.value(*label, centre) - interfaces.value(block[b], centre);
            if (gain > best.gain || (gain == best.gain && cost < best.cost))
                best = {cell, *label, gain, cost};
        }
    }
    return best;
}

// Gives all cells of a block its most frequent label: what ends a dispute between neighbours.
void fill_block(LabelLattice& lattice, Index i, Index j, Index k) {
    const Block block = block_at(lattice, i, j, k);
    std::uint8_t winner = beyond_box;
    std::ptrdiff_t most = 0;
    for (std::uint8_t label : block) {
        const auto count = std::count(block.begin(), block.end(), label);
        if (label != beyond_box && count > most) most = count, winner = label;
    }
    for (int b = 0; b < 8; ++b)
        if (block[b] != beyond_box)
            lattice
                .labels[lattice.offset(i - 1 + (b & 1), j - 1 + (b >> 1 & 1), k - 1 + (b >> 2))] =
                winner;
}

// Cells in no 2 x 2 x 2 block of one label; cells beyond the box agree with any label.
std::vector<std::array<Index, 3>> thin_cells(const LabelLattice& lattice) {
    const auto& n = lattice.size;
    std::vector<bool> is_thick(lattice.labels.size(), false);
    for (Index k = 0; k <= n[2]; ++k)
        for (Index j = 0; j <= n[1]; ++j)
            for (Index i = 0; i <= n[0]; ++i) {
                const Block block = block_at(lattice, i, j, k);
                const std::uint8_t label = *std::min_element(block.begin(), block.end());
                if (label == beyond_box || !std::all_of(block.begin(), block.end(), [&](auto b) {
                        return b == label || b == beyond_box;
                    }))
                    continue;
                for (int b = 0; b < 8; ++b)
                    if (block[b] == label)
                        is_thick[lattice.offset(i - 1 + (b & 1), j - 1 + (b >> 1 & 1),
                                                k - 1 + (b >> 2))] = true;
            }
    std::vector<std::array<Index, 3>> thin;
    for (Index k = 0; k < n[2]; ++k)
        for (Index j = 0; j < n[1]; ++j)
            for (Index i = 0; i < n[0]; ++i)
                if (!is_thick[lattice.offset(i, j, k)]) thin.push_back({i, j, k});
    return thin;
}

// Of the other labels behind a cell's faces the one that the field prefers; its own if none.
std::uint8_t preferred_neighbour(const LabelLattice& lattice, const Interfaces& interfaces, Index i,
                                 Index j, Index k) {
    const std::uint8_t own = lattice.at(i, j, k);
    std::uint8_t best = own;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint8_t label :
         {lattice.at(i - 1, j, k), lattice.at(i + 1, j, k), lattice.at(i, j - 1, k),
          lattice.at(i, j + 1, k), lattice.at(i, j, k - 1), lattice.at(i, j, k + 1)}) {
        if (label == own || label == best || label == beyond_box) continue;
        const double value = interfaces.value(label, lattice.centre(i, j, k));
        if (value < least) least = value, best = label;
    }
    return best;
}

struct Surroundings {
    std::uint8_t label;  ///< that most of the 27 cells have; the cell's own if only two meet
    bool is_uniform;     ///< one label only
};

// Cells beyond the box repeat the nearest cell inside.
Surroundings surroundings(const LabelLattice& lattice, Index i, Index j, Index k) {
    const auto& n = lattice.size;
    std::array<std::uint8_t, 27> labels;
    int count = 0;
    for (Index c = k - 1; c <= k + 1; ++c)
        for (Index b = j - 1; b <= j + 1; ++b)
            for (Index a = i - 1; a <= i + 1; ++a)
                labels[count++] =
                    lattice.at(std::clamp<Index>(a, 0, n[0] - 1), std::clamp<Index>(b, 0, n[1] - 1),
                               std::clamp<Index>(c, 0, n[2] - 1));
    const std::uint8_t own = labels[13];
    if (std::all_of(labels.begin(), labels.end(), [own](auto label) { return label == own; }))
        return {own, true};
    std::sort(labels.begin(), labels.end());
    std::uint8_t best = own;
    int most = 0, kinds = 0;
    for (int begin = 0, end = 0; begin < 27; begin = end, ++kinds) {
        while (end < 27 && labels[end] == labels[begin]) ++end;
        if (end - begin > most || (end - begin == most && labels[begin] == own))
            most = end - begin, best = labels[begin];
    }
    return {kinds < 3 ? own : best, false};
}

}  // namespace

LabelLattice sample_labels(const RegionImage& image, const LabelField& field, double spacing_mm) {
    LabelLattice lattice;
    for (int axis = 0; axis < 3; ++axis) {
        const double length = image.grid.size[axis] * image.grid.spacing[axis];
        lattice.size[axis] = std::max<Index>(2, Index(std::lround(length / spacing_mm)));
        lattice.spacing[axis] = length / lattice.size[axis];
    }
    lattice.labels.resize(std::size_t(lattice.size[0]) * lattice.size[1] * lattice.size[2]);
    const auto uniform = uniform_voxels(image, 3.0 * field.smoothing_mm());
    const Interfaces interfaces(field, image.grid);
    for (Index k = 0; k < lattice.size[2]; ++k)
        for (Index j = 0; j < lattice.size[1]; ++j)
            for (Index i = 0; i < lattice.size[0]; ++i) {
                const Vec3 point = lattice.centre(i, j, k);
                std::array<Index, 3> voxel;
                for (int axis = 0; axis < 3; ++axis)
                    voxel[axis] = std::clamp<Index>(Index(point[axis] / image.grid.spacing[axis]),
                                                    0, image.grid.size[axis] - 1);
                const std::size_t v = image.grid.offset(voxel[0], voxel[1], voxel[2]);
                lattice.labels[lattice.offset(i, j, k)] =
                    uniform[v] ? image.voxels[v]
                               : std::uint8_t(field.region_at(interfaces.to_lps(point)));
            }
    return lattice;
}

void remove_thin_parts(LabelLattice& lattice, const ImageGrid& grid, const LabelField& field) {
    constexpr int max_rounds = 4;
    const Interfaces interfaces(field, grid);
    for (int round = 0; round < max_rounds; ++round) {
        std::vector<std::array<Index, 3>> thin = thin_cells(lattice);
        if (thin.empty()) return;
        // decide for all cells first, so that the result does not depend on their order
        std::vector<std::uint8_t> labels;
        for (const auto& [i, j, k] : thin)
            labels.push_back(preferred_neighbour(lattice, interfaces, i, j, k));
        for (std::size_t cell = 0; cell < thin.size(); ++cell)
            lattice.labels[lattice.offset(thin[cell][0], thin[cell][1], thin[cell][2])] =
                labels[cell];
    }
}

void even_out_contacts(LabelLattice& lattice, int rounds) {
    const auto& n = lattice.size;
    std::vector<std::array<Index, 3>> contacts;
    for (Index k = 0; k < n[2]; ++k)
        for (Index j = 0; j < n[1]; ++j)
            for (Index i = 0; i < n[0]; ++i)
                if (!surroundings(lattice, i, j, k).is_uniform) contacts.push_back({i, j, k});
    std::vector<std::uint8_t> labels(contacts.size());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t c = 0; c < contacts.size(); ++c)
            labels[c] = surroundings(lattice, contacts[c][0], contacts[c][1], contacts[c][2]).label;
        for (std::size_t c = 0; c < contacts.size(); ++c)
            lattice.labels[lattice.offset(contacts[c][0], contacts[c][1], contacts[c][2])] =
                labels[c];
    }
}

void remove_specks(LabelLattice& lattice, double min_volume_mm3) {
    const auto& n = lattice.size;
    const std::array<std::ptrdiff_t, 3> stride{1, n[0], std::ptrdiff_t(n[0]) * n[1]};
    std::vector<std::vector<std::size_t>> pieces;
    std::vector<bool> seen(lattice.labels.size(), false);
    const auto for_neighbours = [&](std::size_t cell, auto&& visit) {
        const std::array<Index, 3> at{Index(cell % n[0]), Index(cell / n[0] % n[1]),
                                      Index(cell / n[0] / n[1])};
        for (int axis = 0; axis < 3; ++axis) {
            if (at[axis] > 0) visit(cell - stride[axis]);
            if (at[axis] + 1 < n[axis]) visit(cell + stride[axis]);
        }
    };
    std::map<std::uint8_t, std::size_t> largest;
    for (std::size_t seed = 0; seed < seen.size(); ++seed) {
        if (seen[seed]) continue;
        std::vector<std::size_t> piece{seed};
        seen[seed] = true;
        for (std::size_t next = 0; next < piece.size(); ++next)
            for_neighbours(piece[next], [&](std::size_t cell) {
                if (seen[cell] || lattice.labels[cell] != lattice.labels[seed]) return;
                seen[cell] = true;
                piece.push_back(cell);
            });
        auto& most = largest[lattice.labels[seed]];
        most = std::max(most, piece.size());
        if (piece.size() * lattice.spacing.prod() < min_volume_mm3)
            pieces.push_back(std::move(piece));
    }
    for (const auto& piece : pieces) {
        const std::uint8_t label = lattice.labels[piece.front()];
        if (label >= first_organ_region && piece.size() == largest[label]) continue;
        std::map<std::uint8_t, int> around;
        for (std::size_t cell : piece)
            for_neighbours(cell, [&](std::size_t other) {
                if (lattice.labels[other] != label) ++around[lattice.labels[other]];
            });
        if (around.empty()) continue;
        const auto winner = std::max_element(around.begin(), around.end(), [](auto& a, auto& b) {
                                return a.second < b.second;
                            })->first;
        for (std::size_t cell : piece) lattice.labels[cell] = winner;
    }
}

void make_well_composed(LabelLattice& lattice, const ImageGrid& grid, const LabelField& field) {
    constexpr int max_rounds = 200, gentle_rounds = 20;
    const Interfaces interfaces(field, grid);
    const auto& n = lattice.size;
    std::vector<std::array<Index, 3>> bad;
    for (Index k = 0; k <= n[2]; ++k)
        for (Index j = 0; j <= n[1]; ++j)
            for (Index i = 0; i <= n[0]; ++i)
                if (!is_manifold(block_at(lattice, i, j, k))) bad.push_back({i, j, k});
    for (int round = 0; round < max_rounds && !bad.empty(); ++round) {
        std::vector<std::array<Index, 3>> next;
        for (const auto& [i, j, k] : bad) {
            if (is_manifold(block_at(lattice, i, j, k))) continue;
            const Switch change = best_switch(lattice, interfaces, i, j, k);
            if (round < gentle_rounds && change.gain > 0)
                lattice.labels[change.cell] = change.label;
            else
                fill_block(lattice, i, j, k);
            for (Index dk = -2; dk <= 2; ++dk)
                for (Index dj = -2; dj <= 2; ++dj)
                    for (Index di = -2; di <= 2; ++di) {
                        const std::array<Index, 3> at{i + di, j + dj, k + dk};
                        if (!is_manifold(block_at(lattice, at[0], at[1], at[2])))
                            next.push_back(at);
                    }
        }
        std::sort(next.begin(), next.end());
        next.erase(std::unique(next.begin(), next.end()), next.end());
        bad = std::move(next);
    }
    if (!bad.empty())
        throw Error(ErrorCode::mesh_failed,
                    "The sampled regions could not be made manifold near the image border or "
                    "between touching organs; use a smaller edge length.");
}

}  // namespace palpate
