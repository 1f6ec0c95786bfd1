// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "host/apps/export/text_out.hpp"
#include "host/apps/export/write_model.hpp"

namespace palpate {
namespace {

using Out = TextOut;

constexpr int volume = 3, tetrahedron = 4;  // Gmsh's dimension and element type

/// Each node belongs to the first region that has it.
std::vector<std::vector<Index>> nodes_by_region(const RecoveredModel& model) {
    std::vector<std::vector<Index>> nodes(model.regions.size());
    std::vector<bool> taken(model.mesh.nodes.size(), false);
    for (std::size_t r = 0; r < model.regions.size(); ++r) {
        for (const Index t : model.regions[r].tets) {
            for (const Index n : model.mesh.tets[t]) {
                if (!taken[n]) nodes[r].push_back(n);
                taken[n] = true;
            }
        }
    }
    return nodes;
}

/// Region r is entity r + 1 and physical group r + 1: labels may be 0, tags may not.
void add_entities(const RecoveredModel& model, Out& out) {
    add(out, "$PhysicalNames\n{}\n", model.regions.size());
    for (std::size_t r = 0; r < model.regions.size(); ++r)
        add(out, "{} {} \"{}\"\n", volume, r + 1, model.regions[r].token);
    add(out, "$EndPhysicalNames\n$Entities\n0 0 0 {}\n", model.regions.size());
    for (std::size_t r = 0; r < model.regions.size(); ++r) {
        Vec3 low = Vec3::Constant(1e30), high = -low;
        for (const Index t : model.regions[r].tets) {
            for (const Index n : model.mesh.tets[t]) {
                low = low.cwiseMin(model.mesh.nodes[n]);
                high = high.cwiseMax(model.mesh.nodes[n]);
            }
        }
        add(out, "{} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} 1 {} 0\n", r + 1, low.x(), low.y(),
            low.z(), high.x(), high.y(), high.z(), r + 1);
    }
    add(out, "$EndEntities\n");
}

void add_nodes(const RecoveredModel& model, Out& out) {
    const auto nodes = nodes_by_region(model);
    add(out, "$Nodes\n{} {} 1 {}\n", nodes.size(), model.mesh.num_nodes(), model.mesh.num_nodes());
    for (std::size_t r = 0; r < nodes.size(); ++r) {
        add(out, "{} {} 0 {}\n", volume, r + 1, nodes[r].size());
        for (const Index n : nodes[r]) add(out, "{}\n", n + 1);
        for (const Index n : nodes[r]) {
            const Vec3& x = model.mesh.nodes[n];
            add(out, "{:.9g} {:.9g} {:.9g}\n", x.x(), x.y(), x.z());
        }
    }
    add(out, "$EndNodes\n");
}

void add_elements(const RecoveredModel& model, Out& out) {
    const Index count = model.mesh.num_tets();
    add(out, "$Elements\n{} {} 1 {}\n", model.regions.size(), count, count);
    for (std::size_t r = 0; r < model.regions.size(); ++r) {
        const ModelRegion& region = model.regions[r];
        add(out, "{} {} {} {}\n", volume, r + 1, tetrahedron, region.tets.size());
        for (const Index t : region.tets) {
            const Tet& tet = model.mesh.tets[t];
            add(out, "{} {} {} {} {}\n", t + 1, tet[0] + 1, tet[1] + 1, tet[2] + 1, tet[3] + 1);
        }
    }
    add(out, "$EndElements\n");
}

void begin_data(const char* section, const char* name, int components, Index count, Out& out) {
    add(out, "${}\n1\n\"{}\"\n1\n0\n3\n0\n{}\n{}\n", section, name, components, count);
}

void add_vectors(const char* name, const std::vector<Vec3>& values, Out& out) {
    begin_data("NodeData", name, 3, static_cast<Index>(values.size()), out);
    for (std::size_t n = 0; n < values.size(); ++n) {
        const Vec3& v = values[n];
        add(out, "{} {:.9g} {:.9g} {:.9g}\n", n + 1, v.x(), v.y(), v.z());
    }
    add(out, "$EndNodeData\n");
}

void add_held(const std::vector<Held>& held, Out& out) {
    begin_data("NodeData", "held", 1, static_cast<Index>(held.size()), out);
    for (std::size_t n = 0; n < held.size(); ++n)
        add(out, "{} {}\n", n + 1, static_cast<int>(held[n]));
    add(out, "$EndNodeData\n");
}

void add_property(const RecoveredModel& model, const char* name, double ModelRegion::*property,
                  Out& out) {
    begin_data("ElementData", name, 1, model.mesh.num_tets(), out);
    for (const ModelRegion& region : model.regions) {
        for (const Index t : region.tets) add(out, "{} {:.12g}\n", t + 1, region.*property);
    }
    add(out, "$EndElementData\n");
}

}  // namespace

std::string gmsh_mesh(const RecoveredModel& model) {
    Out out;
    add(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
    add(out, "$Comments\nRecovered by palpate {}. mm, kPa, mN; LPS.\n$EndComments\n",
        model.version);
    add_entities(model, out);
    add_nodes(model, out);
    add_elements(model, out);
    add_vectors("displacement", model.displacement, out);
    add_vectors("force", model.force, out);
    add_held(model.held, out);
    add_property(model, "stiffness_kpa", &ModelRegion::stiffness_kpa, out);
    add_property(model, "poisson_ratio", &ModelRegion::poisson_ratio, out);
    return fmt::to_string(out);
}

}  // namespace palpate
