// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/model/stiffness_matrix.hpp"

#include <algorithm>

#include "solver/base/multiversion.hpp"
#include "solver/base/parallel.hpp"
#include "solver/elements/tet4.hpp"

namespace palpate {
namespace {

constexpr Index nodes_per_thread = 500;

std::vector<Tet4> all_geometry(const Mesh& mesh) {
    std::vector<Tet4> geometry(mesh.tets.size());
    parallel_ranges(mesh.num_tets(), nodes_per_thread, [&](Index begin, Index end) {
        for (Index t = begin; t < end; ++t) {
            const Tet& tet = mesh.tets[t];
            geometry[t] = tet4_geometry(mesh.nodes[tet[0]], mesh.nodes[tet[1]], mesh.nodes[tet[2]],
                                        mesh.nodes[tet[3]]);
        }
    });
    return geometry;
}

/// Adds the blocks that the corner `a` of tet `t` gives to the block row of its node.
void add_corner(const Model& model, const Tet4& geometry, Index t, int a, StiffnessMatrix& matrix) {
    const Tet& tet = model.mesh.tets[t];
    const LinearElastic& material = model.materials[model.mesh.region[t]];
    const double lambda = material.stiffness_kpa * material.unit_lambda();
    const double mu = material.stiffness_kpa * material.unit_mu();
    const auto row = matrix.graph.items.begin() + matrix.graph.offsets[tet[a]];
    const auto row_end = matrix.graph.items.begin() + matrix.graph.offsets[tet[a] + 1];
    for (int b = 0; b < 4; ++b) {
        const auto entry = std::lower_bound(row, row_end, tet[b]) - matrix.graph.items.begin();
        Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&matrix.blocks[9 * entry]) +=
            tet4_stiffness_block(geometry, a, b, lambda, mu);
    }
}

/// y = sum of blocks x: one block row with `count` blocks at the nodes `items`; y is [3, width].
/// `nonzero` is null if nothing is known.
PALPATE_MULTIVERSION
void multiply_row(const Index* items, const double* blocks, Index count, const double* x,
                  std::size_t width, const unsigned char* nonzero, double* __restrict y) {
    std::fill(y, y + 3 * width, 0.0);
    for (Index k = 0; k < count; ++k) {
        const Index node = items[k];
        if (nonzero && !nonzero[node]) continue;
        const double* a = blocks + 9 * static_cast<std::size_t>(k);
        const double* xn = x + 3 * width * node;
        for (std::size_t c = 0; c < width; ++c) {
            const double x0 = xn[c], x1 = xn[width + c], x2 = xn[2 * width + c];
            y[c] += a[0] * x0 + a[1] * x1 + a[2] * x2;
            y[width + c] += a[3] * x0 + a[4] * x1 + a[5] * x2;
            y[2 * width + c] += a[6] * x0 + a[7] * x1 + a[8] * x2;
        }
    }
}

}  // namespace

StiffnessMatrix assemble_stiffness(const Model& model) {
    StiffnessMatrix matrix;
    matrix.graph = node_graph(model.mesh);
    matrix.num_columns = model.mesh.num_nodes();
    matrix.blocks.assign(9 * matrix.graph.items.size(), 0.0);
    const Adjacency corners = corners_of_nodes(model.mesh);
    const std::vector<Tet4> geometry = all_geometry(model.mesh);
    parallel_ranges(matrix.num_nodes(), nodes_per_thread, [&](Index begin, Index end) {
        for (Index k = corners.offsets[begin]; k < corners.offsets[end]; ++k) {
            const Index corner = corners.items[k];
            add_corner(model, geometry[corner / 4], corner / 4, corner % 4, matrix);
        }
    });
    return matrix;
}

void multiply_rows(const StiffnessMatrix& stiffness, Index first, Index last, const double* x,
                   Index columns, std::span<const unsigned char> nonzero, double* y) {
    const Adjacency& graph = stiffness.graph;
    const std::size_t width = columns;
    for (Index n = first; n < last; ++n) {
        const Index begin = graph.offsets[n];
        multiply_row(&graph.items[begin], &stiffness.blocks[9 * static_cast<std::size_t>(begin)],
                     graph.offsets[n + 1] - begin, x, width,
                     nonzero.empty() ? nullptr : nonzero.data(), y + 3 * width * (n - first));
    }
}

}  // namespace palpate
