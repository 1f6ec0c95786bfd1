// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>
#include <utility>
#include <variant>

#include "solver/base/parallel.hpp"
#include "solver/equilibrium/element_groups.hpp"
#include "solver/equilibrium/element_loops.hpp"
#include "solver/equilibrium/element_points.hpp"
#include "solver/equilibrium/forward_response.hpp"
#include "solver/equilibrium/viscous_step.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/element_parts.hpp"

// What a SolidAssembly goes through, for its own sources alone.
namespace palpate {

template <typename Laws>
struct VariantOf;
template <typename... Laws>
struct VariantOf<std::tuple<Laws...>> {
    using Type = std::variant<Laws...>;
};
using AnyLaw = VariantOf<MaterialLaws<double>>::Type;

struct AssemblyTables {
    SolidModel model;
    std::vector<PointGeometry> geometry;
    Adjacency graph;
    ElementParts parts;
    std::vector<AnyLaw> laws;  ///< by region
    /// [num_elements, nodes, nodes] places of the element's blocks in the matrix.
    std::vector<Index> blocks;
    std::vector<double> factor;              ///< of `ViscousStep`, by region; empty: elastic
    std::vector<Tensor3<double>> prestress;  ///< [num_elements, num_points]
    ElementGroups groups;
    ElementLoops loops;

    AssemblyTables(const SolidModel& from, const ElementLoopOptions& options);
    /// Whether the laws alone are asked, and a device has them.
    bool are_on_device() const { return loops.are_on_device() && factor.empty(); }
    ElementPoints points_of(Index element) const;
    /// The part of [num_elements, num_points] that belongs to an element.
    template <class List>
    auto of_element(List& list, Index element) const {
        const auto points = static_cast<std::size_t>(model.mesh.table().num_points);
        return std::span(list).subspan(element * points, points);
    }
    /// What the changes are in one element.
    std::vector<ElementChange> changes_of(Index element,
                                          const std::vector<SolidChange>& changes) const;
    void find_blocks();
    /// Calls work(law_at) with what gives the law of a point of the element.
    template <class Work>
    void with_laws(Index element, Work&& work) const;
    /// Calls work(element) for all, elements that share a node never at the same time.
    template <class Work>
    void for_each_element(Work&& work) const {
        for_each_group([](Index) { return false; }, work, false);
    }
    /// The same for groups: for elements where `work_of_group(group)` is false, and where there are
    /// none.
    template <class GroupWork, class Work>
    void for_each_group(GroupWork&& work_of_group, Work&& work, bool has_groups = true) const;
    GroupStep step() const { return {factor, prestress}; }
    /// Calls work(element, lane) for those of a group; returns true.
    template <class Work>
    bool for_each_lane(Index group, Work&& work) const {
        int lane = 0;
        for (const Index element : groups.elements_of(group)) work(element, lane++);
        return true;
    }
};

inline constexpr Index parts_per_thread = 2;
/// Below, threads take longer to start than they save.
inline constexpr Index fewest_elements_to_share = 1000;

template <class GroupWork, class Work>
void AssemblyTables::for_each_group(GroupWork&& work_of_group, Work&& work, bool has_groups) const {
    has_groups = has_groups && !groups.is_empty();
    const std::vector<Index>& starts = parts.elements.offsets;
    const auto work_of_part = [&](Index part) {
        if (!has_groups) {
            for (Index e = starts[part]; e < starts[part + 1]; ++e) work(parts.elements.items[e]);
            return;
        }
        for (Index g = groups.first_of(part); g < groups.first_of(part + 1); ++g)
            if (!work_of_group(g))
                for (const Index element : groups.elements_of(g)) work(element);
    };
    // Colours one after the other; the parts of a colour share no node and go side by side.
    const bool is_shared = model.mesh.num_elements() >= fewest_elements_to_share;
    for (Index c = 0; c < parts.parts.num_lists(); ++c) {
        const Index first = parts.parts.offsets[c], count = parts.parts.offsets[c + 1] - first;
        const auto range = [&](Index begin, Index end) {
            for (Index k = begin; k < end; ++k) work_of_part(parts.parts.items[first + k]);
        };
        if (is_shared)
            parallel_ranges(count, parts_per_thread, range);
        else
            range(0, count);
    }
}

template <class Work>
void AssemblyTables::with_laws(Index element, Work&& work) const {
    const Index region = model.mesh.region[element];
    const auto points = static_cast<std::size_t>(model.mesh.table().num_points);
    const bool is_viscous = !factor.empty() && !model.materials[region].relaxation.empty();
    std::visit(
        [&](const auto& law) {
            using Law = std::decay_t<decltype(law)>;
            if (!is_viscous) return work([&](std::size_t) { return law; });
            // A step with relaxation is elastic: (1 + sum c_k) W + Q : E, or W + sum c_k W_iso +
            // Q : E (method.md, 9.7).
            const auto prestress_at = [&](std::size_t q) {
                return prestress[element * points + q];
            };
            if (model.materials[region].relaxation_of == RelaxationOf::total) {
                const TotalRelaxation<Law> total{law, factor[region]};
                work([&](std::size_t q) {
                    return ViscousStep<TotalRelaxation<Law>>{total, prestress_at(q)};
                });
            } else {
                const IsochoricRelaxation<Law> isochoric(law, factor[region]);
                work([&](std::size_t q) {
                    return ViscousStep<IsochoricRelaxation<Law>>{isochoric, prestress_at(q)};
                });
            }
        },
        laws[region]);
}

}  // namespace palpate
