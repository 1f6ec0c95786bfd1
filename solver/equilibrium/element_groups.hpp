// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "solver/base/pack.hpp"
#include "solver/equilibrium/forward_response.hpp"
#include "solver/equilibrium/group_law.hpp"
#include "solver/equilibrium/solid_change.hpp"
#include "solver/model/element_parts.hpp"
#include "solver/model/solid_geometry.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// What a viscous step makes of the laws (`SolidAssembly::set_viscous_step`); empty: they are as
/// they are.
struct GroupStep {
    std::span<const double> factor;              ///< [materials]
    std::span<const Tensor3<double>> prestress;  ///< [num_elements, num_points]
};

/// Elements of a part and a material, four side by side: the element loops of a host, with its
/// vector units. There are no groups in plane stress. A function returns false where a point of any
/// of the elements is not valid, and where it is not done here: for Hooke's law, and for an element
/// that is alone. Then they have to be looked at one by one.
class ElementGroups {
public:
    ElementGroups(const SolidModel& model, const std::vector<PointGeometry>& geometry,
                  const ElementParts& parts);

    /// The groups of part p: [first_of(p), first_of(p + 1)). None at all: no elements are grouped.
    Index first_of(Index part) const { return offsets_[part]; }
    bool is_empty() const { return groups_.empty(); }
    /// One to four.
    std::span<const Index> elements_of(Index group) const {
        return std::span(groups_[group].elements).first(groups_[group].count);
    }

    /// u [3 num_nodes] mm; energy mN mm, force [num_nodes of an element, 3] mN.
    bool force(Index group, const GroupStep& step, const double* u, Pack& energy,
               Pack* force) const;
    /// blocks [num_nodes, num_nodes, 3, 3] mN/mm.
    bool tangent(Index group, const GroupStep& step, const double* u, Pack* blocks) const;
    /// force [changes, num_nodes, 3] mN per unit of each change.
    bool force_changes(Index group, const GroupStep& step, const double* u,
                       const std::vector<SolidChange>& changes, std::vector<Pack>& force) const;
    /// stress [num_points] kPa of what relaxes.
    bool relaxing_stress(Index group, const GroupStep& step, const double* u,
                         Tensor3<Pack>* stress) const;
    /// Its changes [changes, num_points] with du [3 num_nodes, changes] mm and the rest of each.
    bool relaxing_stress_changes(Index group, const GroupStep& step, const double* u,
                                 const Eigen::MatrixXd& du, const std::vector<SolidChange>& changes,
                                 std::vector<Tensor3<Pack>>& stress) const;

private:
    struct Group {
        std::array<Index, Pack::size> elements;  ///< the last one again where there are fewer
        int count;
        Index region;
    };
    bool is_done_here(Index group) const {
        return groups_[group].count > 1 && laws_[groups_[group].region];
    }
    struct Call;
    Call call(Index group, const GroupStep& step, const double* u) const;
    void gather(Index group, const double* u, Pack* gathered) const;
    void gather(Index group, std::span<const Tensor3<double>> tensors,
                Tensor3<Pack>* gathered) const;
    std::vector<ChangeOf<Pack>> changes_of(Index group, const std::vector<SolidChange>& changes,
                                           std::vector<Tensor3<Pack>>& prestress) const;

    const SolidModel* model_;
    SolidLayout layout_;
    std::vector<std::optional<GroupLaw<Pack>::Laws>> laws_;  ///< by region; empty: Hooke's
    std::vector<Group> groups_;
    std::vector<Index> offsets_;  ///< [parts + 1]
    std::vector<Pack> geometry_;  ///< [groups, num_points, reals_per_point]
};

}  // namespace palpate
