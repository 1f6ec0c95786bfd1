// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/grid_mesh.hpp"

#include <algorithm>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

/// Nodes of a regular grid; in a plane there is one layer.
struct Lattice {
    const GridSettings& grid;
    bool is_plane;

    Index node(int i, int j, int k) const {
        const Index row = grid.divisions[0] + 1;
        return i + row * (j + (grid.divisions[1] + 1) * k);
    }
    std::vector<Vec3> nodes() const {
        std::vector<Vec3> places;
        const int layers = is_plane ? 0 : grid.divisions[2];
        for (int k = 0; k <= layers; ++k)
            for (int j = 0; j <= grid.divisions[1]; ++j)
                for (int i = 0; i <= grid.divisions[0]; ++i)
                    places.push_back(place(i, j, is_plane ? 0 : k));
        return places;
    }

private:
    Vec3 place(int i, int j, int k) const {
        const int at[] = {i, j, k};
        Vec3 place = grid.origin_mm;
        for (int c = 0; c < (is_plane ? 2 : 3); ++c)
            place[c] += grid.size_mm[c] * at[c] / grid.divisions[c];
        return place;
    }
};

/// The six tetrahedra along the ways from corner (0,0,0) to (1,1,1) of a cell (Kuhn 1960).
void add_tetrahedra(const Lattice& lattice, int i, int j, int k, SolidMesh& mesh) {
    static constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                         {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    for (int way = 0; way < 6; ++way) {
        int at[3] = {i, j, k};
        Index nodes[4] = {lattice.node(i, j, k)};
        for (int step = 0; step < 3; ++step) {
            ++at[orders[way][step]];
            nodes[step + 1] = lattice.node(at[0], at[1], at[2]);
        }
        if (way >= 3) std::swap(nodes[2], nodes[3]);  // odd orders turn the other way round
        mesh.elements.insert(mesh.elements.end(), nodes, nodes + 4);
    }
}

void add_plane_cell(const Lattice& lattice, int i, int j, SolidMesh& mesh) {
    const Index a = lattice.node(i, j, 0), b = lattice.node(i + 1, j, 0);
    const Index c = lattice.node(i + 1, j + 1, 0), d = lattice.node(i, j + 1, 0);
    if (mesh.type == ElementType::quad4)
        mesh.elements.insert(mesh.elements.end(), {a, b, c, d});
    else if ((i + j) % 2 == 0)
        mesh.elements.insert(mesh.elements.end(), {a, b, c, a, c, d});
    else
        mesh.elements.insert(mesh.elements.end(), {a, b, d, b, c, d});
}

}  // namespace

SolidMesh grid_mesh(const GridSettings& grid, Formulation formulation) {
    const bool is_plane = formulation != Formulation::solid;
    const bool is_known = is_plane
                              ? grid.type == ElementType::quad4 || grid.type == ElementType::tri3
                              : grid.type == ElementType::tet4;
    if (!is_known)
        throw Error(ErrorCode::invalid_argument,
                    "a grid cannot be made of " + element_table(grid.type).name +
                        "; allowed: tet4 in space, quad4 and tri3 in a plane");
    const Lattice lattice{grid, is_plane};
    SolidMesh mesh;
    mesh.type = grid.type;
    mesh.formulation = formulation;
    mesh.nodes = lattice.nodes();
    for (int k = 0; k < (is_plane ? 1 : grid.divisions[2]); ++k)
        for (int j = 0; j < grid.divisions[1]; ++j)
            for (int i = 0; i < grid.divisions[0]; ++i) {
                if (is_plane)
                    add_plane_cell(lattice, i, j, mesh);
                else
                    add_tetrahedra(lattice, i, j, k, mesh);
            }
    mesh.region.assign(mesh.elements.size() / mesh.table().num_nodes, 1);
    return mesh;
}

}  // namespace palpate
