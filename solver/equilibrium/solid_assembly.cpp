// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/solid_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "solver/base/error.hpp"
#include "solver/base/parallel.hpp"
#include "solver/equilibrium/element_slopes.hpp"
#include "solver/equilibrium/forward_response.hpp"
#include "solver/materials/registry.hpp"
#include "solver/model/element_parts.hpp"

namespace palpate {
namespace {

constexpr Index parts_per_thread = 2;
/// Below, threads take longer to start than they save.
constexpr Index fewest_elements_to_share = 1000;

template <typename Laws>
struct VariantOf;
template <typename... Laws>
struct VariantOf<std::tuple<Laws...>> {
    using Type = std::variant<Laws...>;
};
using AnyLaw = VariantOf<MaterialLaws<double>>::Type;

const SolidModel& checked(const SolidModel& model) {
    check_model(model);
    return model;
}

AnyLaw law_of(const SolidMaterial& material) {
    std::optional<AnyLaw> found;
    with_material_law<double>(material.law, material.parameters,
                              [&](const auto& law) { found = law; });
    return *found;
}

}  // namespace

struct SolidAssembly::Tables {
    SolidModel model;
    std::vector<PointGeometry> geometry;
    Adjacency graph;
    ElementParts parts;
    std::vector<AnyLaw> laws;  ///< by region
    /// [num_elements, nodes, nodes] places of the element's blocks in the matrix.
    std::vector<Index> blocks;
    std::vector<double> factor;              ///< of `ViscousStep`, by region; empty: elastic
    std::vector<Tensor3<double>> prestress;  ///< [num_elements, num_points]
    ElementLoops loops;

    Tables(const SolidModel& from, const ElementLoopOptions& options);
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
    void for_each_element(Work&& work) const;
};

SolidAssembly::Tables::Tables(const SolidModel& from, const ElementLoopOptions& options)
    : model(checked(from)), loops(model, options) {
    geometry = point_geometry(model.mesh);
    graph = node_graph(model.mesh);
    parts = element_parts(model.mesh);
    for (const SolidMaterial& material : model.materials) laws.push_back(law_of(material));
    find_blocks();
}

void SolidAssembly::Tables::find_blocks() {
    for (Index e = 0; e < model.mesh.num_elements(); ++e)
        for (const Index a : model.mesh.nodes_of(e))
            for (const Index b : model.mesh.nodes_of(e)) {
                const auto row = graph.items.begin() + graph.offsets[a];
                const auto end = graph.items.begin() + graph.offsets[a + 1];
                // Block (a, b) of the matrix stands in row a, sorted by b.
                blocks.push_back(
                    static_cast<Index>(std::lower_bound(row, end, b) - graph.items.begin()));
            }
}

std::vector<ElementChange> SolidAssembly::Tables::changes_of(
    Index element, const std::vector<SolidChange>& changes) const {
    const Index region = model.mesh.region[element];
    std::vector<ElementChange> here;
    for (const SolidChange& change : changes) {
        ElementChange& one = here.emplace_back();
        if (!change.parameters.empty()) one.parameters = change.parameters[region];
        if (!change.factor.empty()) one.factor = change.factor[region];
        if (!change.prestress.empty()) one.prestress = of_element(change.prestress, element);
    }
    return here;
}

ElementPoints SolidAssembly::Tables::points_of(Index element) const {
    const int points = model.mesh.table().num_points;
    return {model.mesh.nodes_of(element),
            {geometry.data() + static_cast<std::size_t>(element) * points,
             static_cast<std::size_t>(points)}};
}

template <class Work>
void SolidAssembly::Tables::for_each_element(Work&& work) const {
    const std::vector<Index>& starts = parts.elements.offsets;
    // Colours one after the other; the parts of a colour share no node and go side by side.
    const bool is_shared = model.mesh.num_elements() >= fewest_elements_to_share;
    for (Index c = 0; c < parts.parts.num_lists(); ++c) {
        const Index first = parts.parts.offsets[c], count = parts.parts.offsets[c + 1] - first;
        const auto range = [&](Index begin, Index end) {
            for (Index k = begin; k < end; ++k) {
                const Index part = parts.parts.items[first + k];
                for (Index e = starts[part]; e < starts[part + 1]; ++e)
                    work(parts.elements.items[e]);
            }
        };
        if (is_shared)
            parallel_ranges(count, parts_per_thread, range);
        else
            range(0, count);
    }
}

template <class Work>
void SolidAssembly::Tables::with_laws(Index element, Work&& work) const {
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

SolidAssembly::SolidAssembly(const SolidModel& model, const ElementLoopOptions& loops)
    : tables_(std::make_unique<Tables>(model, loops)) {}

SolidAssembly::~SolidAssembly() = default;

const SolidModel& SolidAssembly::model() const { return tables_->model; }

const ElementLoopInfo& SolidAssembly::loops() const { return tables_->loops.describe(); }

InternalForce SolidAssembly::internal_force(const Eigen::VectorXd& u) const {
    const Tables& tables = *tables_;
    InternalForce result;
    if (tables.are_on_device()) {
        const SolidForce found = tables.loops.internal_force(u);
        result.energy = found.energy;
        result.force = Eigen::Map<const Eigen::VectorXd>(found.force.data(), u.size());
        result.is_valid = found.is_valid;
        return result;
    }
    result.force.setZero(tables.model.num_dofs());
    std::vector<double> energy(tables.model.mesh.region.size());
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            const ElementForce found = element_force(tables.model, law_at, points, u);
            energy[e] = found.energy;
            for (std::size_t a = 0; a < points.nodes.size(); ++a)
                // f_a += sum over points V P g_a (method.md, 9.2)
                result.force.segment<3>(3 * points.nodes[a]) += found.force[a];
        });
    });
    // W = sum of the elements' in their order: the same bits with any number of threads
    for (const double part : energy) result.energy += part;
    result.is_valid = std::isfinite(result.energy) && result.force.allFinite();
    if (!result.is_valid) result.energy = std::numeric_limits<double>::infinity();
    return result;
}

BlockMatrix SolidAssembly::make_matrix() const {
    BlockMatrix matrix;
    matrix.graph = tables_->graph;
    matrix.num_columns = tables_->model.mesh.num_nodes();
    matrix.blocks.assign(9 * matrix.graph.items.size(), 0.0);
    return matrix;
}

void SolidAssembly::tangent(const Eigen::VectorXd& u, BlockMatrix& matrix) const {
    const Tables& tables = *tables_;
    if (tables.are_on_device()) return tables.loops.tangent(u, matrix);
    std::fill(matrix.blocks.begin(), matrix.blocks.end(), 0.0);
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        const std::size_t n = points.nodes.size();
        ElementStiffness stiffness;
        tables.with_laws(e, [&](const auto& law_at) {
            element_tangent(tables.model, law_at, points, u, stiffness);
        });
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = 0; b < n; ++b) {
                double* block = matrix.block(tables.blocks[(e * n + a) * n + b]);
                // (K_ab)_ij += sum V g_a,k dP_ik/dH_jl g_b,l (method.md, 9.2)
                for (int k = 0; k < 9; ++k) block[k] += stiffness[9 * (a * n + b) + k];
            }
    });
}

std::vector<std::vector<double>> SolidAssembly::parameter_products(
    const Eigen::VectorXd& u, const Eigen::VectorXd& lambda) const {
    const Tables& tables = *tables_;
    if (tables.are_on_device()) return tables.loops.parameter_products(u, lambda);
    ElementSlopes slopes(tables.model);
    tables.for_each_element([&](Index e) {
        tables.with_laws(e, [&](const auto& law_at) {
            // lambda . df/dp = sum V dP/dp : (sum_a lambda_a g_a^T), with (method.md, 9.12)
            add_parameter_products(tables.model, law_at, tables.points_of(e), u, lambda,
                                   slopes.parameters_of(e));
        });
    });
    return slopes.parameters();
}

std::vector<Eigen::MatrixXd> SolidAssembly::parameter_forces(const Eigen::VectorXd& u) const {
    const Tables& tables = *tables_;
    std::vector<Eigen::MatrixXd> forces;
    for (const SolidMaterial& material : tables.model.materials)
        forces.emplace_back(
            Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(material.parameters.size())));
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        Eigen::MatrixXd& sum = forces[tables.model.mesh.region[e]];
        tables.with_laws(e, [&](const auto& law_at) {
            for (Eigen::Index k = 0; k < sum.cols(); ++k) {
                std::array<Vec3, most_element_nodes> force;
                force.fill(Vec3::Zero());
                // df_a/dp_k = sum V dP/dp_k g_a
                parameter_force(tables.model, law_at, points, u, static_cast<int>(k), force);
                for (std::size_t a = 0; a < points.nodes.size(); ++a)
                    sum.col(k).segment<3>(3 * points.nodes[a]) += force[a];
            }
        });
    });
    return forces;
}

void SolidAssembly::set_viscous_step(std::vector<double> factor,
                                     std::vector<Tensor3<double>> prestress) {
    if (factor.size() != tables_->model.materials.size() ||
        prestress.size() != tables_->geometry.size())
        throw Error(ErrorCode::invalid_argument,
                    "a viscous step needs a factor per material and a stress per point");
    tables_->factor = std::move(factor);
    tables_->prestress = std::move(prestress);
}

std::vector<Tensor3<double>> SolidAssembly::relaxing_stress(const Eigen::VectorXd& u) const {
    const Tables& tables = *tables_;
    const auto points = static_cast<std::size_t>(tables.model.mesh.table().num_points);
    std::vector<Tensor3<double>> stress(tables.geometry.size(), Tensor3<double>{});
    tables.for_each_element([&](Index e) {
        const Index region = tables.model.mesh.region[e];
        if (tables.model.materials[region].relaxation.empty()) return;
        const ElementPoints element = tables.points_of(e);
        PointTensors h;
        tables.with_laws(
            e, [&](const auto& law_at) { law_gradients(tables.model, law_at, element, u, h); });
        const bool is_total = tables.model.materials[region].relaxation_of == RelaxationOf::total;
        std::visit(
            [&](const auto& law) {
                for (std::size_t q = 0; q < points; ++q)
                    // S = F^-1 P of the law, or of its isochoric part, without its history
                    stress[e * points + q] = is_total ? second_piola(law, h[q])
                                                      : second_piola(isochoric_part(law), h[q]);
            },
            tables.laws[region]);
    });
    return stress;
}

std::vector<PointState> SolidAssembly::point_states(const Eigen::VectorXd& u) const {
    const Tables& tables = *tables_;
    const auto points = static_cast<std::size_t>(tables.model.mesh.table().num_points);
    std::vector<PointState> states(tables.geometry.size());
    tables.for_each_element([&](Index e) {
        const ElementPoints element = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            with_response(tables.model, law_at, element, u, [&](const auto& response) {
                PointTensors stress{};
                // H, P and V at each point; P = 0 where matter is inverted
                if (response.is_valid()) response.stress(stress);
                for (std::size_t q = 0; q < points; ++q)
                    states[e * points + q] = {response.gradient(q), stress[q],
                                              element.geometry[q].volume};
            });
        });
    });
    return states;
}

Eigen::VectorXd SolidAssembly::relaxing_stress_gradient(
    const Eigen::VectorXd& u, const std::vector<Tensor3<double>>& slope) const {
    const Tables& tables = *tables_;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(u.size());
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            if constexpr (gives_viscous_step<decltype(law_at)>) {
                // dJ/du_a += sum (dJ/dS : dS/dH) g_a
                const auto found = element_stress_gradient(tables.model, law_at, points, u,
                                                           tables.of_element(slope, e));
                for (std::size_t a = 0; a < points.nodes.size(); ++a)
                    gradient.segment<3>(3 * points.nodes[a]) += found[a];
            }
        });
    });
    return gradient;
}

ViscousSlopes SolidAssembly::viscous_slopes(const Eigen::VectorXd& u, const Eigen::VectorXd& lambda,
                                            const std::vector<Tensor3<double>>& slope) const {
    const Tables& tables = *tables_;
    // dJ = -lambda . df (method.md, 9.14), df by Q, by 1 + sum c_k and by the law's parameters
    const Eigen::VectorXd direction = -lambda;
    ElementSlopes slopes(tables.model);
    ViscousSlopes result;
    result.prestress.assign(slope.size(), Tensor3<double>{});
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        tables.with_laws(e, [&](const auto& law_at) {
            if constexpr (gives_viscous_step<decltype(law_at)>) {
                add_viscous_slopes(tables.model, law_at, points, u, direction,
                                   tables.of_element(slope, e),
                                   {tables.of_element(result.prestress, e), slopes.factor_of(e),
                                    slopes.parameters_of(e)});
            } else {
                add_parameter_products(tables.model, law_at, points, u, direction,
                                       slopes.parameters_of(e));
            }
        });
    });
    result.factor = slopes.factor();
    result.parameters = slopes.parameters();
    return result;
}

Eigen::MatrixXd SolidAssembly::force_changes(const Eigen::VectorXd& u,
                                             const std::vector<SolidChange>& changes) const {
    const Tables& tables = *tables_;
    Eigen::MatrixXd sum =
        Eigen::MatrixXd::Zero(u.size(), static_cast<Eigen::Index>(changes.size()));
    tables.for_each_element([&](Index e) {
        const ElementPoints points = tables.points_of(e);
        std::array<Vec3, most_element_nodes> none;
        none.fill(Vec3::Zero());
        std::vector<std::array<Vec3, most_element_nodes>> forces(changes.size(), none);
        tables.with_laws(e, [&](const auto& law_at) {
            add_force_changes(tables.model, law_at, points, u, tables.changes_of(e, changes),
                              forces);
        });
        for (std::size_t c = 0; c < forces.size(); ++c)
            for (std::size_t a = 0; a < points.nodes.size(); ++a)
                // df_a += sum V dP g_a, u held (method.md, 9.15)
                sum.col(static_cast<Eigen::Index>(c)).segment<3>(3 * points.nodes[a]) +=
                    forces[c][a];
    });
    return sum;
}

std::vector<std::vector<Tensor3<double>>> SolidAssembly::relaxing_stress_changes(
    const Eigen::VectorXd& u, const Eigen::MatrixXd& du,
    const std::vector<SolidChange>& changes) const {
    const Tables& tables = *tables_;
    const auto points = static_cast<std::size_t>(tables.model.mesh.table().num_points);
    std::vector<std::vector<Tensor3<double>>> stress(
        changes.size(), std::vector<Tensor3<double>>(tables.geometry.size(), Tensor3<double>{}));
    tables.for_each_element([&](Index e) {
        tables.with_laws(e, [&](const auto& law_at) {
            if constexpr (gives_viscous_step<decltype(law_at)>)
                palpate::relaxing_stress_changes(
                    tables.model, law_at, tables.points_of(e), u, du, tables.changes_of(e, changes),
                    [&](std::size_t c, std::size_t q, const Tensor3<double>& change) {
                        stress[c][e * points + q] = change;
                    });
        });
    });
    return stress;
}

}  // namespace palpate
