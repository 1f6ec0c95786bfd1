// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "host/apps/export/engineering_units.hpp"
#include "host/apps/export/law_formats.hpp"
#include "host/apps/export/text_out.hpp"
#include "host/apps/export/write_model.hpp"

namespace palpate {
namespace {

using Out = TextOut;

constexpr std::array<char, 3> axis_names{'x', 'y', 'z'};

void add_control(Out& out) {
    add(out, R"(  <Module type="solid"/>
  <Control>
    <analysis>STATIC</analysis>
    <time_steps>10</time_steps>
    <step_size>0.1</step_size>
    <time_stepper type="default">
      <max_retries>10</max_retries>
      <opt_iter>10</opt_iter>
      <dtmin>0.001</dtmin>
      <dtmax>0.1</dtmax>
    </time_stepper>
    <solver type="solid">
      <symmetric_stiffness>symmetric</symmetric_stiffness>
    </solver>
  </Control>
)");
}

void add_materials(const RecoveredModel& model, Out& out) {
    const std::string law = febio_material_type(model.law);
    add(out, "  <Material>\n");
    int id = 0;
    for (const ModelRegion& region : model.regions) {
        add(out, "    <!-- {} -->\n", model.description_of(region));
        add(out, "    <material id=\"{}\" name=\"{}\" type=\"{}\">\n", ++id, region.token, law);
        add(out, "      <density>1e-09</density>\n      <E>{:.12g}</E>\n      <v>{:.12g}</v>\n",
            mpa_from_kpa(region.stiffness_kpa), region.poisson_ratio);
        add(out, "    </material>\n");
    }
    add(out, "  </Material>\n");
}

void add_node_set(const char* name, const std::vector<Index>& nodes, Out& out) {
    if (nodes.empty()) return;
    add(out, "    <NodeSet name=\"{}\">", name);
    for (std::size_t k = 0; k < nodes.size(); ++k) add(out, "{}{}", k ? "," : "", nodes[k] + 1);
    add(out, "</NodeSet>\n");
}

void add_mesh_section(const RecoveredModel& model, Out& out) {
    add(out, "  <Mesh>\n    <Nodes name=\"nodes\">\n");
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        add(out, "      <node id=\"{}\">{:.9g},{:.9g},{:.9g}</node>\n", n + 1, x.x(), x.y(), x.z());
    }
    add(out, "    </Nodes>\n");
    for (const ModelRegion& region : model.regions) {
        add(out, "    <Elements type=\"tet4\" name=\"{}\">\n", region.token);
        for (const Index t : region.tets) {
            const Tet& tet = model.mesh.tets[t];
            add(out, "      <elem id=\"{}\">{},{},{},{}</elem>\n", t + 1, tet[0] + 1, tet[1] + 1,
                tet[2] + 1, tet[3] + 1);
        }
        add(out, "    </Elements>\n");
    }
    add_node_set("fixed", model.nodes_that_are(Held::fixed), out);
    add_node_set("driven", model.nodes_that_are(Held::driven), out);
    add(out, "  </Mesh>\n  <MeshDomains>\n");
    for (const ModelRegion& region : model.regions)
        add(out, "    <SolidDomain name=\"{0}\" mat=\"{0}\"/>\n", region.token);
    add(out, "  </MeshDomains>\n");
}

/// One value per driven node, which the loads name.
void add_wall_data(const RecoveredModel& model, WallLoad load, Out& out) {
    const std::vector<Index> driven = model.nodes_that_are(Held::driven);
    if (driven.empty()) return;
    add(out, "  <MeshData>\n");
    if (load == WallLoad::displacement) {
        for (int c = 0; c < 3; ++c) {
            add(out, "    <NodeData name=\"wall_{}\" node_set=\"driven\" data_type=\"scalar\">\n",
                axis_names[c]);
            for (std::size_t k = 0; k < driven.size(); ++k)
                add(out, "      <node lid=\"{}\">{:.12g}</node>\n", k + 1,
                    model.displacement[driven[k]][c]);
            add(out, "    </NodeData>\n");
        }
    } else {
        add(out, "    <NodeData name=\"wall_force\" node_set=\"driven\" data_type=\"vec3\">\n");
        for (std::size_t k = 0; k < driven.size(); ++k) {
            const Vec3& f = model.force[driven[k]];
            add(out, "      <node lid=\"{}\">{:.12g},{:.12g},{:.12g}</node>\n", k + 1,
                newton_from_mn(f.x()), newton_from_mn(f.y()), newton_from_mn(f.z()));
        }
        add(out, "    </NodeData>\n");
    }
    add(out, "  </MeshData>\n");
}

void add_boundary(const RecoveredModel& model, WallLoad load, Out& out) {
    const bool has_walls = !model.nodes_that_are(Held::driven).empty();
    add(out, "  <Boundary>\n");
    if (!model.nodes_that_are(Held::fixed).empty()) {
        add(out, R"(    <bc name="fixed" node_set="fixed" type="zero displacement">
      <x_dof>1</x_dof>
      <y_dof>1</y_dof>
      <z_dof>1</z_dof>
    </bc>
)");
    }
    for (int c = 0; has_walls && load == WallLoad::displacement && c < 3; ++c) {
        add(out, R"(    <bc name="wall_{0}" node_set="driven" type="prescribed displacement">
      <dof>{0}</dof>
      <value lc="1" type="map">wall_{0}</value>
      <relative>0</relative>
    </bc>
)",
            axis_names[c]);
    }
    add(out, "  </Boundary>\n");
    if (!has_walls || load == WallLoad::displacement) return;
    add(out, R"(  <Loads>
    <nodal_load name="wall_force" node_set="driven" type="nodal_force">
      <value lc="1" type="map">wall_force</value>
    </nodal_load>
  </Loads>
)");
}

}  // namespace

std::string febio_model(const RecoveredModel& model, WallLoad load) {
    Out out;
    add(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n");
    add(out, "  <!-- Recovered by palpate {}. Units: mm, MPa, N. Axes: LPS. -->\n", model.version);
    add_control(out);
    add_materials(model, out);
    add_mesh_section(model, out);
    add_wall_data(model, load, out);
    add_boundary(model, load, out);
    add(out, R"(  <LoadData>
    <load_controller id="1" name="ramp" type="loadcurve">
      <interpolate>LINEAR</interpolate>
      <extend>CONSTANT</extend>
      <points>
        <pt>0,0</pt>
        <pt>1,1</pt>
      </points>
    </load_controller>
  </LoadData>
  <Output>
    <plotfile type="febio">
      <var type="displacement"/>
      <var type="stress"/>
      <var type="reaction forces"/>
    </plotfile>
  </Output>
</febio_spec>
)");
    return fmt::to_string(out);
}

}  // namespace palpate
