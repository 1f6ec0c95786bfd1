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

/// Adds the blocks that the corners [first, last) give to the block rows of their nodes: the
/// formula of `tet4_stiffness_block`, written out for speed.
///   lame  [num_materials, 2] lambda and mu, kPa
PALPATE_MULTIVERSION
void add_corners(const Mesh& mesh, const Index* corners, Index first, Index last,
                 const Tet4* shapes, const double* lame, StiffnessMatrix& matrix) {
    for (Index k = first; k < last; ++k) {
        const Index t = corners[k] / 4;
        const int a = corners[k] % 4;
        const Tet& tet = mesh.tets[t];
        const Tet4& shape = shapes[t];
        const double lambda = shape.volume * lame[2 * mesh.region[t]];
        const double mu = shape.volume * lame[2 * mesh.region[t] + 1];
        const double* ga = shape.gradient[a].data();
        const Index row = matrix.graph.offsets[tet[a]];
        for (int b = 0; b < 4; ++b) {
            Index entry = row;
            while (matrix.graph.items[entry] != tet[b]) ++entry;
            double* block = matrix.blocks.data() + 9 * static_cast<std::size_t>(entry);
            const double* gb = shape.gradient[b].data();
            const double shear = mu * (ga[0] * gb[0] + ga[1] * gb[1] + ga[2] * gb[2]);
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j)
                    block[3 * i + j] += lambda * ga[i] * gb[j] + mu * gb[i] * ga[j];
                block[4 * i] += shear;
            }
        }
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
    const std::vector<Tet4> shapes = all_geometry(model.mesh);
    std::vector<double> lame;
    for (const LinearElastic& m : model.materials) {
        lame.push_back(m.stiffness_kpa * m.unit_lambda());
        lame.push_back(m.stiffness_kpa * m.unit_mu());
    }
    parallel_ranges(matrix.num_nodes(), nodes_per_thread, [&](Index begin, Index end) {
        add_corners(model.mesh, corners.items.data(), corners.offsets[begin], corners.offsets[end],
                    shapes.data(), lame.data(), matrix);
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
