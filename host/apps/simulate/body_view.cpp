// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/body_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "host/apps/simulate/mesh_picture.hpp"
#include "host/apps/simulate/obstacle_shape.hpp"
#include "host/apps/simulate/simulation_findings.hpp"
#include "host/page/markup.hpp"

namespace palpate {
namespace {

/// States that the page has room for: the first, the last and the one that is shown among them.
std::vector<std::size_t> states_in_view(const SimulationResult& result) {
    constexpr std::size_t most_states = 21;
    const std::size_t last = result.states.size() - 1, shown = shown_state(result);
    const std::size_t steps = std::min(last, most_states - 1);
    std::vector<std::size_t> states{0};
    for (std::size_t k = 1; k <= steps; ++k) states.push_back((k * last + steps / 2) / steps);
    const auto place = std::lower_bound(states.begin(), states.end(), shown);
    if (*place != shown) states.insert(place, shown);
    return states;
}

/// What is known per element, and how it is shown.
struct CellField {
    ShownField field;
    double smallest = 0;  ///< of its colour scale: less is rounding
    double (*value)(const CellFields& cells, Index element);
};

const std::vector<CellField>& cell_values() {
    using Cells = const CellFields&;
    const auto stress = [](const char* name, auto value) {
        return CellField{{.name = name, .unit = "kPa", .is_signed = true}, 1e-9, value};
    };
    static const std::vector<CellField> fields{
        {{.name = "von Mises stress", .unit = "kPa"},
         0,
         [](Cells c, Index e) { return c.von_mises_kpa[e]; }},
        stress("stress xx", [](Cells c, Index e) { return c.stress_kpa[e][0]; }),
        stress("stress yy", [](Cells c, Index e) { return c.stress_kpa[e][1]; }),
        stress("stress zz", [](Cells c, Index e) { return c.stress_kpa[e][2]; }),
        {{.name = "volume change", .unit = "%", .is_signed = true},
         0.01,
         [](Cells c, Index e) { return 100 * (c.volume_ratio[e] - 1); }},
        {{.name = "stored energy", .unit = "kPa", .right = "mN mm per mm³"},
         0,
         [](Cells c, Index e) { return c.energy_density_kpa[e]; }},
    };
    return fields;
}

/// Triangles of a patch of `body_shape`: corners, or corners and middles in turn.
std::vector<Triangle> triangles_of(const std::vector<Index>& rim) {
    if (rim.size() == 6)
        return {{rim[5], rim[0], rim[1]},
                {rim[1], rim[2], rim[3]},
                {rim[3], rim[4], rim[5]},
                {rim[1], rim[3], rim[5]}};
    std::vector<Triangle> triangles;
    for (std::size_t a = 1; a + 1 < rim.size(); ++a)
        triangles.push_back({rim[0], rim[a], rim[a + 1]});
    return triangles;
}

std::vector<Triangle> surface_triangles(const SolidMesh& mesh) {
    std::vector<Triangle> triangles;
    for (const auto& patch : body_shape(mesh).patches)
        for (const Triangle& triangle : triangles_of(patch)) triangles.push_back(triangle);
    return triangles;
}

using NodeFlags = std::vector<std::uint8_t>;  ///< [num_nodes]

void mark(NodeFlags& flags, const std::vector<Triangle>& triangles) {
    for (const Triangle& triangle : triangles)
        for (const Index node : triangle) flags[node] = 1;
}

/// The elements of one region on all nodes, which they are, and the surface round them.
struct RegionMesh {
    SolidMesh mesh;
    std::vector<Index> elements = {};
    std::vector<Triangle> triangles = {};
    bool is_inside = false;  ///< of a solid: no part of it reaches the surface of the body
};

RegionMesh region_mesh(const SolidMesh& all, Index region) {
    RegionMesh part{all};
    part.mesh.elements.clear();
    part.mesh.region.clear();
    for (Index e = 0; e < all.num_elements(); ++e) {
        if (all.region[e] != region) continue;
        const auto nodes = all.nodes_of(e);
        part.mesh.elements.insert(part.mesh.elements.end(), nodes.begin(), nodes.end());
        part.mesh.region.push_back(region);
        part.elements.push_back(e);
    }
    part.triangles = surface_triangles(part.mesh);
    return part;
}

/// The regions. Where one lies inside others its surface is not drawn twice: they go without it.
std::vector<RegionMesh> region_meshes(const SolidMesh& mesh, std::size_t count) {
    std::vector<RegionMesh> parts;
    for (std::size_t region = 0; region < count; ++region)
        parts.push_back(region_mesh(mesh, static_cast<Index>(region)));
    if (count == 1 || mesh.formulation != Formulation::solid) return parts;
    NodeFlags is_outer(mesh.nodes.size(), 0), is_inner = is_outer;
    mark(is_outer, surface_triangles(mesh));
    const auto all_in = [](const NodeFlags& flags) {
        return [&flags](const Triangle& t) { return flags[t[0]] && flags[t[1]] && flags[t[2]]; };
    };
    for (RegionMesh& part : parts) {
        part.is_inside =
            std::none_of(part.triangles.begin(), part.triangles.end(), all_in(is_outer));
        if (part.is_inside) mark(is_inner, part.triangles);
    }
    for (RegionMesh& part : parts)
        if (!part.is_inside) std::erase_if(part.triangles, all_in(is_inner));
    return parts;
}

/// Numbers the nodes that the triangles have from 0, in `triangles`; which they are.
std::vector<Index> used_nodes(std::vector<Triangle>& triangles, std::size_t num_nodes) {
    std::vector<Index> number(num_nodes, -1), nodes;
    for (Triangle& triangle : triangles)
        for (Index& node : triangle) {
            if (number[node] < 0) {
                number[node] = static_cast<Index>(nodes.size());
                nodes.push_back(node);
            }
            node = number[node];
        }
    return nodes;
}

/// Adds the mirror image about x = 0; what lies there is its own.
void add_mirror_image(SurfaceInView& s) {
    const auto mirrored = [](std::vector<Vec3>& vectors) {
        const std::size_t count = vectors.size();
        for (std::size_t v = 0; v < count; ++v)
            vectors.emplace_back(-vectors[v].x(), vectors[v].y(), vectors[v].z());
    };
    const auto count = static_cast<Index>(s.shape.vertices.size());
    const std::vector<Vec3> half = s.shape.vertices;
    const auto image = [&](Index v) { return half[v].x() == 0 ? v : count + v; };
    mirrored(s.shape.vertices);
    for (std::size_t t = 0, end = s.shape.triangles.size(); t < end; ++t) {
        const auto [a, b, c] = s.shape.triangles[t];
        s.shape.triangles.push_back({image(a), image(c), image(b)});
    }
    for (auto& u : s.displacement) mirrored(u);
    for (auto& field : s.values)
        for (auto& values : field) {
            values.reserve(2 * values.size());
            std::copy_n(values.begin(), values.size(), std::back_inserter(values));
        }
}

SurfaceInView region_surface(const SimulationResult& result, std::size_t region,
                             const RegionMesh& part, const std::vector<std::size_t>& states) {
    const std::vector<Index>& labels = result.prepared.labels;
    SurfaceInView s{.name = labels.size() == 1 ? "body" : fmt::format("region {}", labels[region]),
                    .colour = list_colour(region),
                    .is_inside = part.is_inside};
    s.shape.triangles = part.triangles;
    const std::vector<Index> nodes = used_nodes(s.shape.triangles, part.mesh.nodes.size());
    for (const Index node : nodes) s.shape.vertices.push_back(part.mesh.nodes[node]);
    s.values.assign(1 + cell_values().size(), {});
    for (const std::size_t k : states) {
        const SimulationState& state = result.states[k];
        std::vector<Vec3>& u = s.displacement.emplace_back();
        for (auto f = s.values.begin() + 1; f != s.values.end(); ++f) f->emplace_back();
        if (k == 0) continue;  // at rest all is 0
        for (const Index node : nodes)
            u.push_back(state.displacement.segment<3>(3 * static_cast<Eigen::Index>(node)));
        for (std::size_t f = 0; f < cell_values().size(); ++f) {
            std::vector<double> cells;
            for (const Index e : part.elements)
                cells.push_back(cell_values()[f].value(state.cells, e));
            const std::vector<double> nodal = at_nodes(part.mesh, cells);
            for (const Index node : nodes) s.values[f + 1].back().push_back(nodal[node]);
        }
    }
    return s;
}

SurfaceInView obstacle_surface(const SimulationResult& result, std::size_t obstacle,
                               const std::vector<std::size_t>& states,
                               const Eigen::AlignedBox3d& body) {
    const ObstacleSettings& settings = result.settings.obstacles[obstacle];
    SurfaceInView s{.name = settings.name, .colour = list_colour(1), .is_glass = true};
    s.shape =
        obstacle_shape(settings.obstacle, body, result.mesh().formulation != Formulation::solid);
    for (const std::size_t k : states)
        s.displacement.emplace_back(s.shape.vertices.size(),
                                    result.states[k].obstacle_motion_mm[obstacle]);
    return s;
}

std::vector<ShownField> fields_of(const std::vector<SurfaceInView>& surfaces) {
    constexpr double nearly_all = 0.98;  ///< of the largest displacement, for a rounder number
    constexpr double most = 0.99;  ///< of values per element: those at sharp corners stand out
    const auto largest_of = [&](double part, const auto& values_of) {
        std::vector<double> all;
        for (const SurfaceInView& s : surfaces) values_of(s, all);
        return quantile_of_sizes(all, part);
    };
    std::vector<ShownField> fields{{.name = "displacement", .unit = "mm", .is_displacement = true}};
    fields[0].ranges =
        round_ranges(nearly_all * largest_of(1, [](const SurfaceInView& s, auto& all) {
                         for (const auto& u : s.displacement)
                             for (const Vec3& v : u) all.push_back(v.norm());
                     }));
    for (std::size_t f = 0; f < cell_values().size(); ++f) {
        const CellField& cell = cell_values()[f];
        fields.push_back(cell.field);
        const double largest = largest_of(most, [&](const SurfaceInView& s, auto& all) {
            for (const auto& values : s.values[f + 1])
                all.insert(all.end(), values.begin(), values.end());
        });
        fields.back().ranges = round_ranges(std::max(largest, cell.smallest));
    }
    return fields;
}

std::string note_of(const SimulationResult& result, std::size_t num_shown) {
    std::string note;
    if (result.mesh().formulation == Formulation::axisymmetric)
        note =
            "The section through the axis, which runs upward in the middle; its left half is "
            "the mirror image; zz runs round the axis. ";
    if (num_shown < result.states.size())
        note += fmt::format("{} of {} states are on this page. ", num_shown, result.states.size());
    if (num_shown == 2)
        note += "Below 100 % displacements and values are in proportion, not solved for. ";
    return note +
           "Stresses are means of the elements round each node; their colours end where 99 % of "
           "all values are below.";
}

}  // namespace

SurfaceView body_view(const SimulationResult& result) {
    const std::vector<std::size_t> states = states_in_view(result);
    const SolidMesh& mesh = result.mesh();
    const bool is_mirrored = mesh.formulation == Formulation::axisymmetric;
    SurfaceView view{.label = "The body as it deforms",
                     .outline_name = "At rest",
                     .note = note_of(result, states.size()),
                     .without_webgl = "The pictures below show them from one side.",
                     .has_creases = true,
                     .has_static = true};
    if (mesh.formulation != Formulation::solid) {
        view.azimuth = 0;
        view.elevation = std::numbers::pi / 2;
    }
    for (const std::size_t k : states)
        view.states.push_back(k == 0 ? "at rest" : time_text(result, result.states[k].time_s));
    view.first = static_cast<std::size_t>(
        std::find(states.begin(), states.end(), shown_state(result)) - states.begin());
    Eigen::AlignedBox3d box;
    for (const Vec3& node : mesh.nodes) box.extend(node);
    const auto parts = region_meshes(mesh, result.prepared.labels.size());
    for (std::size_t region = 0; region < parts.size(); ++region)
        view.surfaces.push_back(region_surface(result, region, parts[region], states));
    view.plain_name = parts.size() > 1 ? "region" : "";
    view.fields = fields_of(view.surfaces);
    for (std::size_t k = 0; k < result.settings.obstacles.size(); ++k)
        view.surfaces.push_back(obstacle_surface(result, k, states, box));
    if (is_mirrored)
        for (SurfaceInView& s : view.surfaces) add_mirror_image(s);
    view.factor =
        enlargement(mesh, largest_displacement(result.states[shown_state(result)]).length_mm);
    view.most_triangles = std::max<std::size_t>(12000, 120000 / states.size());
    return view;
}

}  // namespace palpate
