// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/element_groups.hpp"

#include <algorithm>
#include <optional>

#include "solver/equilibrium/group_loops.hpp"

namespace palpate {

namespace {

using GroupLaws = GroupLaw<Pack>::Laws;

std::optional<GroupLaws> group_law_of(const SolidMaterial& material) {
    std::optional<GroupLaws> found;
    with_material_law<Pack>(material.law, material.parameters, [&](const auto& law) {
        if constexpr (!is_small_strain<std::decay_t<decltype(law)>>) found = law;
    });
    return found;
}

constexpr Index own_nodes[most_element_nodes] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};

}  // namespace

ElementGroups::ElementGroups(const SolidModel& model, const std::vector<PointGeometry>& geometry,
                             const ElementParts& parts)
    : model_(&model) {
    const std::vector<Index>& starts = parts.elements.offsets;
    offsets_.assign(starts.size(), 0);
    if (model.mesh.formulation == Formulation::plane_stress) return;
    for (const SolidMaterial& material : model.materials) laws_.push_back(group_law_of(material));
    layout_ = {model.mesh.table().num_nodes, model.mesh.table().num_points,
               model.mesh.formulation == Formulation::axisymmetric,
               model.volume == VolumeTreatment::element_mean};
    std::vector<Index> elements = parts.elements.items;
    const auto region_of = [&](Index element) { return model.mesh.region[element]; };
    for (std::size_t part = 0; part + 1 < starts.size(); ++part) {
        const auto begin = elements.begin() + starts[part],
                   end = elements.begin() + starts[part + 1];
        std::stable_sort(begin, end, [&](Index a, Index b) { return region_of(a) < region_of(b); });
        for (auto element = begin; element != end; ++element) {
            const bool is_new = Index(groups_.size()) == offsets_[part] ||
                                groups_.back().count == Pack::size ||
                                groups_.back().region != region_of(*element);
            if (is_new) groups_.push_back({{}, 0, region_of(*element)});
            Group& group = groups_.back();
            std::fill(group.elements.begin() + group.count, group.elements.end(), *element);
            ++group.count;
        }
        offsets_[part + 1] = Index(groups_.size());
    }
    for (const Group& group : groups_)
        for (int q = 0; q < layout_.num_points; ++q) {
            const auto add = [&](auto&& number) {
                Pack& pack = geometry_.emplace_back();
                for (int lane = 0; lane < Pack::size; ++lane)
                    pack.set(
                        lane,
                        number(
                            geometry[std::size_t(group.elements[lane]) * layout_.num_points + q]));
            };
            for (int a = 0; a < layout_.num_nodes; ++a)
                for (int i = 0; i < 3; ++i)
                    add([&](const PointGeometry& point) { return point.gradient[a][i]; });
            add([](const PointGeometry& point) { return point.volume; });
            for (int a = 0; a < layout_.num_nodes && layout_.has_hoop; ++a)
                add([&](const PointGeometry& point) { return point.hoop[a]; });
        }
}

/// What the loops over the points of a group take.
struct ElementGroups::Call {
    GroupElement element;
    Pack u[3 * most_element_nodes];
    bool is_viscous;
    ElasticGroup elastic;
    ViscousGroup viscous;
};

/// [num_nodes of an element, 3]
void ElementGroups::gather(Index at, const double* u, Pack* gathered) const {
    for (int lane = 0; lane < Pack::size; ++lane) {
        Pack* to = gathered;
        for (const Index node : model_->mesh.nodes_of(groups_[at].elements[lane]))
            for (int i = 0; i < 3; ++i) (to++)->set(lane, u[3 * node + i]);
    }
}

/// [num_points]
void ElementGroups::gather(Index at, std::span<const Tensor3<double>> tensors,
                           Tensor3<Pack>* gathered) const {
    const auto points = static_cast<std::size_t>(layout_.num_points);
    for (int lane = 0; lane < Pack::size; ++lane)
        for (std::size_t q = 0; q < points; ++q) {
            const Tensor3<double>& from = tensors[groups_[at].elements[lane] * points + q];
            for (int i = 0; i < 9; ++i) gathered[q].m[i].set(lane, from.m[i]);
        }
}

ElementGroups::Call ElementGroups::call(Index at, const GroupStep& step, const double* u) const {
    const auto points = static_cast<std::size_t>(layout_.num_points);
    Call made;
    made.element = {own_nodes,
                    geometry_.data() + std::size_t(at) * points * layout_.reals_per_point(),
                    layout_};
    gather(at, u, made.u);
    const Index region = groups_[at].region;
    const SolidMaterial& material = model_->materials[region];
    GroupLaw<Pack> law;
    law.laws = &*laws_[region];
    law.relaxes_as_a_whole = material.relaxation_of == RelaxationOf::total;
    made.is_viscous = !step.factor.empty() && !material.relaxation.empty();
    if (!made.is_viscous) {
        made.elastic = {law};
        return made;
    }
    if (law.relaxes_as_a_whole)
        law.of_all = step.factor[region];
    else
        law.of_isochoric = step.factor[region] - 1;
    Tensor3<Pack> prestress[most_element_points];
    gather(at, step.prestress, prestress);
    for (std::size_t q = 0; q < points; ++q) made.viscous.laws[q] = {law, prestress[q]};
    return made;
}

/// The changes in this group; `prestress` keeps theirs.
std::vector<GroupChange> ElementGroups::changes_of(Index at,
                                                   const std::vector<SolidChange>& changes,
                                                   std::vector<Tensor3<Pack>>& prestress) const {
    const auto points = static_cast<std::size_t>(layout_.num_points);
    const Index region = groups_[at].region;
    prestress.resize(points * changes.size());
    std::vector<GroupChange> here(changes.size());
    for (std::size_t c = 0; c < changes.size(); ++c) {
        if (!changes[c].parameters.empty()) here[c].parameters = changes[c].parameters[region];
        if (!changes[c].factor.empty()) here[c].factor = changes[c].factor[region];
        if (changes[c].prestress.empty()) continue;
        Tensor3<Pack>* const own = prestress.data() + points * c;
        gather(at, changes[c].prestress, own);
        here[c].prestress = {own, points};
    }
    return here;
}

bool ElementGroups::force(Index group, const GroupStep& step, const double* u, Pack& energy,
                          Pack* force) const {
    if (!is_done_here(group)) return false;
    const Call made = call(group, step, u);
    return made.is_viscous ? group_force(made.viscous, made.element, made.u, energy, force)
                           : group_force(made.elastic, made.element, made.u, energy, force);
}

bool ElementGroups::tangent(Index group, const GroupStep& step, const double* u,
                            Pack* blocks) const {
    if (!is_done_here(group)) return false;
    const Call made = call(group, step, u);
    return made.is_viscous ? group_tangent(made.viscous, made.element, made.u, blocks)
                           : group_tangent(made.elastic, made.element, made.u, blocks);
}

bool ElementGroups::force_changes(Index group, const GroupStep& step, const double* u,
                                  const std::vector<SolidChange>& changes,
                                  std::vector<Pack>& force) const {
    if (!is_done_here(group)) return false;
    const Call made = call(group, step, u);
    std::vector<Tensor3<Pack>> prestress;
    const auto here = changes_of(group, changes, prestress);
    force.resize(changes.size() * 3 * std::size_t(layout_.num_nodes));
    return made.is_viscous
               ? group_force_changes(made.viscous, made.element, made.u, here, force.data())
               : group_force_changes(made.elastic, made.element, made.u, here, force.data());
}

bool ElementGroups::relaxing_stress(Index group, const GroupStep& step, const double* u,
                                    Tensor3<Pack>* stress) const {
    if (!is_done_here(group)) return false;
    const Call made = call(group, step, u);
    return made.is_viscous && group_relaxing_stress(made.viscous, made.element, made.u, stress);
}

bool ElementGroups::relaxing_stress_changes(Index group, const GroupStep& step, const double* u,
                                            const Eigen::MatrixXd& du,
                                            const std::vector<SolidChange>& changes,
                                            std::vector<Tensor3<Pack>>& stress) const {
    if (!is_done_here(group)) return false;
    const Call made = call(group, step, u);
    if (!made.is_viscous) return false;
    std::vector<Tensor3<Pack>> prestress;
    const auto here = changes_of(group, changes, prestress);
    const auto numbers = 3 * std::size_t(layout_.num_nodes);
    std::vector<Pack> along(changes.size() * numbers);
    for (std::size_t c = 0; c < changes.size(); ++c)
        gather(group, du.col(Eigen::Index(c)).data(), along.data() + c * numbers);
    stress.resize(changes.size() * std::size_t(layout_.num_points));
    return group_relaxing_stress_changes(made.viscous, made.element, made.u, along.data(), here,
                                         stress.data());
}

}  // namespace palpate
