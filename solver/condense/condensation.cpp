// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/condense/condensation.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/condense/region_mechanics.hpp"
#include "solver/equilibrium/solid_assembly.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/node_rows.hpp"

namespace palpate {
namespace {

constexpr Index columns_per_call = 128;  ///< bounds the memory: [num_dofs, 128] twice

/// What a node is to the condensation.
enum class Role : unsigned char { interior, observed, driven };

struct NodeRoles {
    std::vector<Role> role;       ///< [num_nodes]
    std::vector<Index> position;  ///< [num_nodes] in its own list, -1 for interior nodes
};

NodeRoles assign_roles(const SolidModel& model, const std::vector<Index>& observed,
                       const std::vector<Index>& driven) {
    NodeRoles roles{std::vector<Role>(model.mesh.nodes.size(), Role::interior),
                    std::vector<Index>(model.mesh.nodes.size(), -1)};
    const auto mark = [&](const std::vector<Index>& nodes, Role role, const char* name) {
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const Index n = nodes[i];
            if (n < 0 || n >= model.mesh.num_nodes() || roles.role[n] != Role::interior)
                throw Error(ErrorCode::invalid_argument,
                            "Condensation: entry " + std::to_string(i) + " of the " + name +
                                " nodes, node " + std::to_string(n) +
                                ", is outside the mesh or listed twice.");
            roles.role[n] = role;
            roles.position[n] = static_cast<Index>(i);
        }
    };
    mark(observed, Role::observed, "observed");
    mark(driven, Role::driven, "driven");
    for (Index n : observed)
        for (Index c = 0; c < 3; ++c)
            if (model.prescribed[3 * n + c])
                throw Error(ErrorCode::invalid_argument,
                            "Condensation: observed node " + std::to_string(n) +
                                " has a prescribed displacement; take it out of the observed list "
                                "or free it.");
    return roles;
}

bool is_fully_prescribed(const SolidModel& model, Index node) {
    return model.prescribed[3 * node] && model.prescribed[3 * node + 1] &&
           model.prescribed[3 * node + 2];
}

/// An interior node of two regions would couple them, and S(E) = sum E_r S_r would not hold.
void require_separate_interiors(const SolidModel& model, const NodeRoles& roles) {
    std::vector<Index> region_of(model.mesh.nodes.size(), -1);
    for (Index e = 0; e < model.mesh.num_elements(); ++e)
        for (const Index n : model.mesh.nodes_of(e)) {
            if (roles.role[n] != Role::interior || is_fully_prescribed(model, n)) continue;
            const Index region = model.mesh.region[e];
            // K_ii would have blocks of both regions, E_r K_r,ii + E_s K_s,ii, whose inverse is no
            // sum.
            if (region_of[n] >= 0 && region_of[n] != region)
                throw Error(ErrorCode::invalid_argument,
                            "Condensation: node " + std::to_string(n) + " lies between region " +
                                std::to_string(region_of[n]) + " and region " +
                                std::to_string(region) +
                                ", but is neither observed, driven nor prescribed; add the nodes "
                                "between regions to the observed nodes.");
            region_of[n] = region;
        }
}

/// The elements of one region as a model of its own, at unit modulus, with every observed and
/// driven node prescribed.
struct SubModel {
    SolidModel model;
    std::vector<Index> nodes;           ///< their numbers in the whole model
    std::vector<Index> observed_nodes;  ///< node numbers in `model`, in the order of the list
    std::vector<Index> driven_nodes;
    CondensedRegion block;  ///< `region`, `observed` and `driven` are filled in
};

SubModel extract_region(const SolidModel& model, const NodeRoles& roles, Index region) {
    SubModel sub;
    sub.block.region = region;
    sub.model.mesh.type = model.mesh.type;
    std::vector<Index> local(model.mesh.nodes.size(), -1);
    std::vector<std::pair<Index, Index>> observed, driven;  // position in the list, local node
    for (Index e = 0; e < model.mesh.num_elements(); ++e) {
        if (model.mesh.region[e] != region) continue;
        for (const Index n : model.mesh.nodes_of(e)) {
            if (local[n] < 0) {
                local[n] = sub.model.mesh.num_nodes();
                // Boundary nodes b are prescribed, interior nodes i free: the solves are with
                // K_r,ii.
                sub.model.mesh.nodes.push_back(model.mesh.nodes[n]);
                sub.nodes.push_back(n);
                const bool boundary = roles.role[n] != Role::interior;
                for (Index c = 0; c < 3; ++c)
                    sub.model.prescribed.push_back(boundary || model.prescribed[3 * n + c]);
                if (roles.role[n] == Role::observed)
                    observed.emplace_back(roles.position[n], local[n]);
                if (roles.role[n] == Role::driven) driven.emplace_back(roles.position[n], local[n]);
            }
            sub.model.mesh.elements.push_back(local[n]);
        }
        sub.model.mesh.region.push_back(0);
    }
    if (sub.model.mesh.region.empty()) return sub;
    // K_r at 1 kPa: S(E) = sum_r E_r S_r then holds for every modulus (method.md, 1.3).
    sub.model.materials = {model.materials[region]};
    SolidMaterial& material = sub.model.materials[0];
    material.parameters = parameters_of_stiffness(material.law, material.parameters, 1);
    std::sort(observed.begin(), observed.end());
    std::sort(driven.begin(), driven.end());
    for (const auto& [position, node] : observed) {
        sub.block.observed.push_back(position);
        sub.observed_nodes.push_back(node);
    }
    for (const auto& [position, node] : driven) {
        sub.block.driven.push_back(position);
        sub.driven_nodes.push_back(node);
    }
    return sub;
}

Index num_columns_of(const SubModel& sub) {
    return 3 * static_cast<Index>(sub.observed_nodes.size());
}

/// Every free node must hang together with a prescribed one, or K_ii is singular.
void require_held(const SubModel& sub) {
    const Adjacency graph = node_graph(sub.model.mesh);
    const Index num_nodes = sub.model.mesh.num_nodes();
    // Spreads from all held nodes along the edges of the mesh; what is not reached floats.
    std::vector<unsigned char> reached(num_nodes, 0);
    std::vector<Index> front;
    for (Index n = 0; n < num_nodes; ++n)
        if (sub.model.prescribed[3 * n] || sub.model.prescribed[3 * n + 1] ||
            sub.model.prescribed[3 * n + 2]) {
            reached[n] = 1;
            front.push_back(n);
        }
    while (!front.empty()) {
        const Index n = front.back();
        front.pop_back();
        for (Index k = graph.offsets[n]; k < graph.offsets[n + 1]; ++k)
            if (!reached[graph.items[k]]) {
                reached[graph.items[k]] = 1;
                front.push_back(graph.items[k]);
            }
    }
    const auto floating = std::count(reached.begin(), reached.end(), 0);
    if (floating > 0)
        throw Error(ErrorCode::solve_failed,
                    "Condensation: region " + std::to_string(sub.block.region) + " has " +
                        std::to_string(floating) +
                        " nodes in a part that touches no observed, driven or prescribed node and "
                        "floats freely; remove that part from the mesh or fix it.");
}

/// Nodal forces of the columns of x at `nodes`, [3 |nodes|, columns].
Eigen::MatrixXd reactions(const StiffnessMatrix& stiffness, const std::vector<Index>& nodes,
                          const Columns& x) {
    Columns force(3 * nodes.size(), x.cols());
    parallel_ranges(static_cast<Index>(nodes.size()), 64, [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i)
            // rows of K_r x at the nodes asked for: with x = [1; -K_ii^-1 K_ib], K x = S at nodes
            // of b
            multiply_rows(stiffness, nodes[i], nodes[i] + 1, x.data(), static_cast<Index>(x.cols()),
                          {}, force.row(3 * i).data());
    });
    return force;
}

void add_to(LinearSolverSummary& total, const LinearSolverSummary& part) {
    total.iterations += part.iterations;
    total.refinements = std::max(total.refinements, part.refinements);
    total.relative_residual = std::max(total.relative_residual, part.relative_residual);
    total.seconds += part.seconds;
    total.message = part.message;
}

/// What a region is made of. `options` hold the number of columns to be expected.
using MakeMechanics = std::function<std::unique_ptr<RegionMechanics>(
    const SubModel& sub, const LinearSolverOptions& options)>;

/// Motions of a region's observed nodes: sets `b` [dofs of the region, columns] there, those from
/// number `first` on.
using SetMotions = std::function<void(Index first, Columns& b)>;
/// Takes the region's displacements x for the motions from number `first` on.
using TakeColumns =
    std::function<void(const RegionMechanics& region, Index first, const Columns& x)>;

class Condensation {
public:
    Condensation(const LinearSolverOptions& options, const ProgressSink& progress, Index columns)
        : options_(options), progress_(progress), total_columns_(columns) {}

    /// x_b as `set` has it and x_i = -K_ii^-1 K_ib x_b, all other boundary dofs at 0.
    void run(const SubModel& sub, const MakeMechanics& make_mechanics, Index num_columns,
             const SetMotions& set, const TakeColumns& take) {
        require_held(sub);
        LinearSolverOptions options = options_;
        options.expected_columns = num_columns;
        const auto region = make_mechanics(sub, options);
        if (num_columns > most_columns_) {
            most_columns_ = num_columns;
            summary.solver = region->describe();
        }
        for (Index first = 0; first < num_columns; first += columns_per_call) {
            const Index count = std::min(columns_per_call, num_columns - first);
            Columns b = Columns::Zero(sub.model.num_dofs(), count);
            set(first, b);
            take(*region, first, solved(sub, *region, b));
        }
    }

    CondensationSummary summary;

private:
    Columns solved(const SubModel& sub, RegionMechanics& region, const Columns& b) {
        Columns x;
        const LinearSolverSummary part = region.solve(b, x);
        add_to(summary.linear, part);
        summary.columns += static_cast<Index>(b.cols());
        if (!part.converged)
            throw Error(ErrorCode::solve_failed, "Condensation: the interior solve of region " +
                                                     std::to_string(sub.block.region) +
                                                     " stopped at a relative residual of " +
                                                     std::to_string(part.relative_residual) + ": " +
                                                     part.message + ".");
        report_progress(
            progress_, "condensing",
            static_cast<double>(summary.columns) / std::max<Index>(total_columns_, 1),
            std::to_string(summary.columns) + " of " + std::to_string(total_columns_) + " columns");
        return x;
    }

    const LinearSolverOptions& options_;
    const ProgressSink& progress_;
    Index total_columns_;
    Index most_columns_ = 0;  ///< of the regions so far
};

void symmetrise(Eigen::MatrixXd& matrix) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j)
        for (Eigen::Index i = 0; i < j; ++i)
            // (S + S^T) / 2: what solves to a finite residual leave of asymmetry
            matrix(i, j) = matrix(j, i) = 0.5 * (matrix(i, j) + matrix(j, i));
}

/// All columns of the observed nodes.
void condense_region(Condensation& condensation, SubModel& sub,
                     const MakeMechanics& make_mechanics) {
    const Index num_columns = num_columns_of(sub);
    sub.block.observed_observed.resize(num_columns, num_columns);
    sub.block.observed_driven.resize(num_columns, 3 * sub.driven_nodes.size());
    const auto unit_motions = [&](Index first, Columns& b) {
        for (Index j = 0; j < b.cols(); ++j) {
            const Index dof = first + j;
            b(3 * sub.observed_nodes[dof / 3] + dof % 3, j) = 1;
        }
    };
    const auto take = [&](const RegionMechanics& region, Index first, const Columns& x) {
        // Columns of S_r = K_bb - K_bi K_ii^-1 K_ib (method.md, 1.2), those of observed dofs only.
        sub.block.observed_observed.middleCols(first, x.cols()) =
            reactions(region.stiffness(), sub.observed_nodes, x);
        if (!sub.driven_nodes.empty())
            // S_od = S_do^T: the rows at driven nodes of columns that are solved for anyway
            sub.block.observed_driven.middleRows(first, x.cols()) =
                reactions(region.stiffness(), sub.driven_nodes, x).transpose();
    };
    condensation.run(sub, make_mechanics, num_columns, unit_motions, take);
    symmetrise(sub.block.observed_observed);
}

/// Those rows of motions of all observed or driven nodes that are of a region's.
Eigen::MatrixXd rows_of(const Eigen::MatrixXd& motions, const std::vector<Index>& positions) {
    Eigen::MatrixXd rows(3 * positions.size(), motions.cols());
    for (std::size_t i = 0; i < positions.size(); ++i)
        rows.middleRows<3>(3 * i) = motions.middleRows<3>(3 * positions[i]);
    return rows;
}

CondensedMotions condense_motions(Condensation& condensation, const SubModel& sub,
                                  const MakeMechanics& make_mechanics,
                                  const Eigen::MatrixXd& observed_motions,
                                  const Eigen::MatrixXd& driven_motions) {
    const Eigen::MatrixXd own = rows_of(observed_motions, sub.block.observed);
    const Eigen::MatrixXd walls = rows_of(driven_motions, sub.block.driven);
    CondensedMotions found{sub.block.region, Eigen::MatrixXd(own.cols(), own.cols()),
                           Eigen::MatrixXd::Zero(own.cols(), walls.cols())};
    const auto set = [&](Index first, Columns& b) {
        for (std::size_t i = 0; i < sub.observed_nodes.size(); ++i)
            b.middleRows<3>(3 * sub.observed_nodes[i]) = own.block(3 * i, first, 3, b.cols());
    };
    const auto take = [&](const RegionMechanics& region, Index first, const Columns& x) {
        // V^T S_oo V and (S_do V)^T D
        found.stiffness.middleCols(first, x.cols()).noalias() =
            own.transpose() * reactions(region.stiffness(), sub.observed_nodes, x);
        if (!sub.driven_nodes.empty())
            found.coupling.middleRows(first, x.cols()).noalias() =
                reactions(region.stiffness(), sub.driven_nodes, x).transpose() * walls;
    };
    condensation.run(sub, make_mechanics, static_cast<Index>(own.cols()), set, take);
    symmetrise(found.stiffness);
    return found;
}

/// The regions that an observed node touches.
std::vector<SubModel> observed_regions(const SolidModel& model, const std::vector<Index>& observed,
                                       const std::vector<Index>& driven) {
    check_model(model);
    const NodeRoles roles = assign_roles(model, observed, driven);
    require_separate_interiors(model, roles);
    std::vector<SubModel> parts;
    for (Index region = 0; region < static_cast<Index>(model.materials.size()); ++region) {
        SubModel sub = extract_region(model, roles, region);
        if (!sub.observed_nodes.empty()) parts.push_back(std::move(sub));
    }
    return parts;
}

/// `work(condensation, part)` for all of them. `columns`: solves of all together.
template <typename Work>
void condense_each(std::vector<SubModel>& parts, Index columns, const LinearSolverOptions& options,
                   CondensationSummary* summary, const ProgressSink& progress, Work&& work) {
    const auto start = std::chrono::steady_clock::now();
    Condensation condensation(options, progress, columns);
    for (SubModel& sub : parts) work(condensation, sub);
    if (!summary) return;
    *summary = condensation.summary;
    summary->linear.converged = true;
    summary->seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void check_state(const Eigen::VectorXd& displacement, const SolidModel& model) {
    if (displacement.size() != model.num_dofs())
        throw Error(ErrorCode::invalid_argument,
                    "Condensation: a state needs 3 displacements per node, " +
                        std::to_string(model.num_dofs()) + ", not " +
                        std::to_string(displacement.size()) + ".");
}

void check_motions(const Eigen::MatrixXd& motions, const std::vector<Index>& nodes,
                   const char* name) {
    if (motions.rows() != static_cast<Eigen::Index>(3 * nodes.size()))
        throw Error(ErrorCode::invalid_argument,
                    "Condensation: motions of the " + std::string(name) + " nodes need " +
                        std::to_string(3 * nodes.size()) + " rows, not " +
                        std::to_string(motions.rows()) + ".");
}

}  // namespace

std::vector<CondensedRegion> condense(const SolidModel& model, const std::vector<Index>& observed,
                                      const std::vector<Index>& driven,
                                      const LinearSolverOptions& options,
                                      CondensationSummary* summary, const ProgressSink& progress) {
    const auto at_rest = [](const SubModel& sub, const LinearSolverOptions& solver) {
        return make_region_at_rest(sub.model, solver);
    };
    std::vector<SubModel> parts = observed_regions(model, observed, driven);
    Index columns = 0;
    for (const SubModel& sub : parts) columns += num_columns_of(sub);
    std::vector<CondensedRegion> result;
    condense_each(parts, columns, options, summary, progress,
                  [&](Condensation& condensation, SubModel& sub) {
                      condense_region(condensation, sub, at_rest);
                      result.push_back(std::move(sub.block));
                  });
    return result;
}

std::vector<CondensedMotions> condense_at(
    const Eigen::VectorXd& displacement, const SolidModel& model,
    const std::vector<Index>& observed, const std::vector<Index>& driven,
    const Eigen::MatrixXd& observed_motions, const Eigen::MatrixXd& driven_motions,
    const LinearSolverOptions& options, CondensationSummary* summary,
    const ProgressSink& progress) {
    check_state(displacement, model);
    check_motions(observed_motions, observed, "observed");
    check_motions(driven_motions, driven, "driven");
    const auto tangent = [&](const SubModel& sub, const LinearSolverOptions& solver) {
        return make_tangent_mechanics(sub.model, at_nodes(displacement, sub.nodes), solver);
    };
    std::vector<SubModel> parts = observed_regions(model, observed, driven);
    const auto columns = static_cast<Index>(observed_motions.cols() * parts.size());
    std::vector<CondensedMotions> result;
    condense_each(parts, columns, options, summary, progress,
                  [&](Condensation& condensation, const SubModel& sub) {
                      result.push_back(condense_motions(condensation, sub, tangent,
                                                        observed_motions, driven_motions));
                  });
    return result;
}

std::vector<RegionForce> region_forces(const Eigen::VectorXd& displacement, const SolidModel& model,
                                       const std::vector<Index>& observed,
                                       const std::vector<Index>& driven) {
    check_state(displacement, model);
    std::vector<RegionForce> result;
    for (const SubModel& sub : observed_regions(model, observed, driven)) {
        const Eigen::VectorXd u = at_nodes(displacement, sub.nodes);
        const Eigen::VectorXd force = SolidAssembly(sub.model).internal_force(u).force;
        RegionForce own{sub.block.region, Eigen::VectorXd::Zero(3 * observed.size())};
        for (std::size_t i = 0; i < sub.observed_nodes.size(); ++i)
            own.force.segment<3>(3 * sub.block.observed[i]) =
                force.segment<3>(3 * sub.observed_nodes[i]);
        result.push_back(std::move(own));
    }
    return result;
}

}  // namespace palpate
