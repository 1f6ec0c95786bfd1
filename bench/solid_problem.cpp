// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "bench/solid_problem.hpp"

#include <utility>

#include "solver/model/quadratic_mesh.hpp"
#include "tests/fixtures/meshes.hpp"

namespace palpate::bench {

fixtures::LoadedModel compressed_box(const SolidSize& size) {
    const Index cells = size.cells;
    Mesh box = fixtures::box_mesh({cells, cells, cells}, Vec3(60, 60, 60));
    fixtures::set_inclusion(box, [](const Vec3& x) { return (x - Vec3(30, 30, 30)).norm() < 15; });
    SolidMesh mesh = solid_mesh_of(box);
    if (size.is_quadratic) mesh = with_edge_nodes(mesh);
    SolidModel model = fixtures::solid_model(mesh, {"neo-hookean", {10, 0.35}});
    model.materials.push_back({"neo-hookean", {90, 0.40}});
    return fixtures::between_plates(std::move(model), Vec3(0, 0, -6));
}

}  // namespace palpate::bench
