// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/build_model.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "host/apps/recover/modelling/regions.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "solver/base/error.hpp"
#include "solver/materials/linear.hpp"

namespace palpate {
namespace {

enum class NodeSet : std::uint8_t { free, outer_boundary, observed, driven, fixed };

const OrganSettings* organ_of(const Settings& settings, Index region) {
    return region >= first_organ_region ? &settings.organs[region - first_organ_region] : nullptr;
}

NodeSet set_of(const OrganSettings& organ) {
    switch (organ.role) {
        case Role::fixed:
            return NodeSet::fixed;
        case Role::driven:
            return NodeSet::driven;
        case Role::tissue:
            return NodeSet::observed;
        case Role::background:
            break;
    }
    return NodeSet::free;
}

bool is_outer_boundary(const RegionSurface& surface, Index triangle) {
    const auto& [back, front] = surface.regions[triangle];
    return (back == background_region && front == outside_region) ||
           (front == background_region && back == outside_region);
}

/// Each node gets the strongest set of the triangles round it; caps give none.
std::vector<NodeSet> node_sets(const BodyMesh& mesh, const Settings& settings) {
    const RegionSurface& surface = mesh.surface;
    const bool outer_fixed = settings.background && settings.background->outer_boundary_fixed;
    std::vector<NodeSet> sets(mesh.mesh.nodes.size(), NodeSet::free);
    for (Index t = 0; t < surface.num_triangles(); ++t) {
        NodeSet strongest = NodeSet::free;
        if (outer_fixed && is_outer_boundary(surface, t)) strongest = NodeSet::outer_boundary;
        for (const Index region : surface.regions[t]) {
            const auto* organ = organ_of(settings, region);
            if (!organ) continue;
            if (surface.on_image_border[t] && organ->role != Role::fixed) continue;
            strongest = std::max(strongest, set_of(*organ));
        }
        for (const Index node : surface.triangles[t]) sets[node] = std::max(sets[node], strongest);
    }
    return sets;
}

/// As given; where its search starts if it is unknown.
template <typename Material>
double ratio_of(const Material& material, const PriorSettings& prior) {
    if (!material.poisson_unknown) return material.poisson_ratio;
    return std::clamp(material.poisson_ratio, prior.poisson_lowest, prior.poisson_highest);
}

SolidMaterial material_of(double stiffness_kpa, double poisson_ratio) {
    return {TissueLaw{}.name, {stiffness_kpa, poisson_ratio}};
}

std::vector<SolidMaterial> materials_of(const Settings& settings) {
    const LinearElastic nothing;  // of regions without elements
    std::vector<SolidMaterial> materials(settings.num_regions(),
                                         material_of(nothing.stiffness_kpa, nothing.poisson_ratio));
    if (settings.background) {
        materials[background_region] = material_of(settings.background->stiffness_kpa,
                                                   ratio_of(*settings.background, settings.prior));
    }
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        const auto& organ = settings.organs[k];
        materials[first_organ_region + k] =
            material_of(organ.stiffness_kpa.value_or(prior_median_kpa(settings)),
                        ratio_of(organ, settings.prior));
    }
    return materials;
}

bool touches_border(const RegionSurface& surface, Index region) {
    for (Index t = 0; t < surface.num_triangles(); ++t) {
        if (!surface.on_image_border[t]) continue;
        if (surface.regions[t][0] == region || surface.regions[t][1] == region) return true;
    }
    return false;
}

std::vector<ObservedSurface> observed_surfaces(const BodyMesh& mesh, const Settings& settings) {
    std::vector<ObservedSurface> surfaces;
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        if (settings.organs[k].role == Role::fixed) continue;
        ObservedSurface observed;
        observed.region = first_organ_region + static_cast<Index>(k);
        observed.driven = settings.organs[k].role == Role::driven;
        observed.cut_by_image = touches_border(mesh.surface, observed.region);
        observed.surface =
            surface_of_region(mesh.surface, observed.region, false, &observed.node_of);
        if (observed.surface.triangles.empty()) {
            throw Error(ErrorCode::input_unusable,
                        fmt::format("organ '{}' has no surface inside the image: it fills the "
                                    "field of view or was lost in the mesh; use more nodes",
                                    settings.organs[k].name));
        }
        surfaces.push_back(std::move(observed));
    }
    return surfaces;
}

struct DisjointSets {
    std::vector<Index> parent;
    explicit DisjointSets(Index n) : parent(n) { std::iota(parent.begin(), parent.end(), 0); }
    Index find(Index a) {
        while (parent[a] != a) a = parent[a] = parent[parent[a]];
        return a;
    }
    void join(Index a, Index b) { parent[find(a)] = find(b); }
};

/// Every piece of tissue must hang on at least three held nodes, or its rigid motion is free.
void check_supported(const RecoveryModel& recovery, const Settings& settings) {
    const SolidMesh& mesh = recovery.model.mesh;
    DisjointSets pieces(mesh.num_nodes());
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        for (const Index node : mesh.nodes_of(e)) pieces.join(mesh.nodes_of(e)[0], node);
    }
    std::vector<Index> held(mesh.nodes.size(), 0);
    for (const Index node : recovery.fixed) ++held[pieces.find(node)];
    for (const Index node : recovery.driven) ++held[pieces.find(node)];
    for (Index e = 0; e < mesh.num_elements(); ++e) {
        if (held[pieces.find(mesh.nodes_of(e)[0])] >= 3) continue;
        throw Error(ErrorCode::input_unusable,
                    fmt::format("region '{}' touches neither a driven nor a fixed surface, so "
                                "nothing can move it; add a [background], a driven or a fixed "
                                "organ next to it",
                                name_of_region(settings, mesh.region[e])));
    }
}

void check_something_observed(const RecoveryModel& recovery) {
    if (!recovery.surfaces.empty()) return;
    throw Error(ErrorCode::input_unusable,
                "no organ is 'tissue' or 'driven', so there is nothing to match; give at least "
                "one such organ in the settings");
}

}  // namespace

double prior_median_kpa(const Settings& settings) {
    double reference = 10.0;
    if (settings.background) {
        reference = settings.background->stiffness_kpa;
    } else {
        for (const auto& organ : settings.organs) {
            if (organ.stiffness_kpa && !organ.hollow) reference = *organ.stiffness_kpa;
        }
    }
    return settings.prior.stiffness_median_ratio * reference;
}

RecoveryModel build_model(const BodyMesh& mesh, const Settings& settings) {
    RecoveryModel recovery;
    recovery.model.mesh = mesh.mesh;
    recovery.model.materials = materials_of(settings);
    recovery.model.prescribed.assign(3 * mesh.mesh.nodes.size(), 0);

    const auto sets = node_sets(mesh, settings);
    for (Index node = 0; node < mesh.mesh.num_nodes(); ++node) {
        const bool held = sets[node] == NodeSet::fixed || sets[node] == NodeSet::outer_boundary;
        if (held) recovery.fixed.push_back(node);
        if (sets[node] == NodeSet::driven) recovery.driven.push_back(node);
        if (sets[node] == NodeSet::observed) recovery.observed.push_back(node);
        if (held || sets[node] == NodeSet::driven) {
            for (int c = 0; c < 3; ++c) recovery.model.prescribed[3 * node + c] = 1;
        }
    }
    recovery.surfaces = observed_surfaces(mesh, settings);
    if (settings.background && settings.background->poisson_unknown) {
        recovery.unknown_ratio.push_back(background_region);
    }
    for (std::size_t k = 0; k < settings.organs.size(); ++k) {
        const auto& organ = settings.organs[k];
        const Index region = first_organ_region + static_cast<Index>(k);
        if (!organ.hollow && !organ.stiffness_kpa) recovery.unknown.push_back(region);
        if (!organ.hollow && organ.poisson_unknown) recovery.unknown_ratio.push_back(region);
    }
    check_something_observed(recovery);
    check_supported(recovery, settings);
    check_model(recovery.model);
    return recovery;
}

}  // namespace palpate
