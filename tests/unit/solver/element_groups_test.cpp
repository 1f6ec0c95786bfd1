// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/equilibrium/element_groups.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solver/equilibrium/element_response.hpp"
#include "tests/fixtures/solid_models.hpp"

namespace palpate {
namespace {

using namespace fixtures;

constexpr double rounding = 1e-11;

/// A model in groups, and what one element alone says.
struct Grouped {
    SolidModel model;
    std::vector<PointGeometry> geometry = point_geometry(model.mesh);
    ElementParts parts = element_parts(model.mesh);
    ElementGroups groups{model, geometry, parts};
    Eigen::VectorXd u = random_vector(model.num_dofs());
    std::vector<double> factor;
    std::vector<Tensor3<double>> prestress;

    explicit Grouped(SolidModel from) : model(std::move(from)) {}

    Eigen::VectorXd random_vector(Index size) const {
        std::mt19937 random(7);
        std::normal_distribution<double> normal(0, 0.02);
        Eigen::VectorXd drawn(size);
        for (Index d = 0; d < size; ++d) drawn[d] = normal(random);
        if (model.mesh.formulation != Formulation::solid)
            for (Index n = 0; n < model.mesh.num_nodes(); ++n) drawn[3 * n + 2] = 0;
        return drawn;
    }
    GroupStep step() const { return {factor, prestress}; }
    /// A group that is not done side by side.
    bool is_alone(Index group) const {
        const auto elements = groups.elements_of(group);
        return elements.size() == 1 ||
               model.materials[model.mesh.region[elements[0]]].law == "linear";
    }
    std::size_t num_points() const { return std::size_t(model.mesh.table().num_points); }
    ElementPoints points_of(Index e) const {
        return {model.mesh.nodes_of(e),
                std::span(geometry).subspan(e * num_points(), num_points())};
    }
    std::span<const Tensor3<double>> of_element(const std::vector<Tensor3<double>>& list,
                                                Index e) const {
        return std::span(list).subspan(e * num_points(), num_points());
    }
    /// Calls work(law_at) with the laws that `SolidAssembly` has for single elements.
    template <class Work>
    void with_laws(Index e, const Work& work) const {
        const SolidMaterial& material = model.materials[model.mesh.region[e]];
        with_material_law<double>(material.law, material.parameters, [&](const auto& law) {
            using Law = std::decay_t<decltype(law)>;
            if (factor.empty()) return work([&](std::size_t) { return law; });
            const auto history = of_element(prestress, e);
            const double by = factor[model.mesh.region[e]];
            if (material.relaxation_of == RelaxationOf::total)
                work([&](std::size_t q) {
                    return ViscousStep<TotalRelaxation<Law>>{{law, by}, history[q]};
                });
            else
                work([&](std::size_t q) {
                    return ViscousStep<IsochoricRelaxation<Law>>{{law, by}, history[q]};
                });
        });
    }
    void relax(RelaxationOf which) {
        std::mt19937 random(8);
        std::normal_distribution<double> normal(0, 0.3);
        for (SolidMaterial& material : model.materials) {
            material.relaxation = {{0.7, 2}};
            material.relaxation_of = which;
            factor.push_back(1.4);
        }
        for (std::size_t p = 0; p < geometry.size(); ++p) {
            Tensor3<double> drawn{};
            for (const int k : {0, 4, 8}) drawn.m[k] = normal(random);
            drawn.m[1] = drawn.m[3] = normal(random);
            prestress.push_back(drawn);
        }
    }
};

/// |list of packs in a lane - expected| over |expected|
template <class Found, class Expected>
double relative_error(const Found& found, const Expected& expected, std::size_t count, int lane) {
    double off = 0, size = 0;
    for (std::size_t k = 0; k < count; ++k) {
        off += std::pow(found[k][lane] - expected[k], 2);
        size += std::pow(expected[k], 2);
    }
    return std::sqrt(off / size);
}

void expect_groups_as_elements(const Grouped& grouped) {
    const std::size_t nodes = std::size_t(grouped.model.mesh.table().num_nodes);
    Index seen = 0;
    for (Index part = 0; part < grouped.parts.elements.num_lists(); ++part)
        for (Index g = grouped.groups.first_of(part); g < grouped.groups.first_of(part + 1); ++g) {
            Pack energy, force[3 * most_element_nodes];
            Pack blocks[9 * most_element_nodes * most_element_nodes];
            seen += Index(grouped.groups.elements_of(g).size());
            if (grouped.is_alone(g)) {
                EXPECT_FALSE(
                    grouped.groups.force(g, grouped.step(), grouped.u.data(), energy, force));
                continue;
            }
            ASSERT_TRUE(grouped.groups.force(g, grouped.step(), grouped.u.data(), energy, force));
            ASSERT_TRUE(grouped.groups.tangent(g, grouped.step(), grouped.u.data(), blocks));
            int lane = 0;
            for (const Index e : grouped.groups.elements_of(g)) {
                grouped.with_laws(e, [&](const auto& law_at) {
                    const ElementForce alone =
                        element_force(grouped.model, law_at, grouped.points_of(e), grouped.u);
                    ElementStiffness stiffness;
                    element_tangent(grouped.model, law_at, grouped.points_of(e), grouped.u,
                                    stiffness);
                    EXPECT_NEAR(energy[lane], alone.energy, rounding * std::abs(alone.energy));
                    EXPECT_LT(relative_error(force, alone.force[0].data(), 3 * nodes, lane),
                              rounding);
                    EXPECT_LT(relative_error(blocks, stiffness, 9 * nodes * nodes, lane), rounding);
                });
                ++lane;
            }
        }
    EXPECT_EQ(seen, grouped.model.mesh.num_elements());
}

TEST(ElementGroups, AnswerAsTheirElementsDoOneByOne) {
    for (const SolidModel& model : solid_models()) {
        SCOPED_TRACE(name_of(model));
        const Grouped grouped(model);
        EXPECT_EQ(grouped.groups.is_empty(), model.mesh.formulation == Formulation::plane_stress);
        if (!grouped.groups.is_empty()) expect_groups_as_elements(grouped);
    }
}

/// A box with a law of large strains, Hooke's and a second one, from element to element.
TEST(ElementGroups, AreOfOneMaterialEach) {
    SolidModel model = solid_model(solid_meshes()[0], solid_materials()[1]);
    model.materials = {solid_materials()[1], solid_materials()[0], solid_materials()[3]};
    for (Index e = 0; e < model.mesh.num_elements(); ++e) model.mesh.region[e] = e % 3;
    const Grouped grouped(model);
    expect_groups_as_elements(grouped);
    Index num_alone = 0;
    const Index count = grouped.groups.first_of(grouped.parts.elements.num_lists());
    for (Index g = 0; g < count; ++g) {
        num_alone += grouped.groups.elements_of(g).size() == 1;
        for (const Index e : grouped.groups.elements_of(g))
            EXPECT_EQ(model.mesh.region[e],
                      model.mesh.region[grouped.groups.elements_of(g).front()]);
    }
    // at most one of each material in each part
    EXPECT_LE(num_alone, 3 * grouped.parts.elements.num_lists());
    EXPECT_LE(count, (model.mesh.num_elements() + 3) / 4 + 3 * grouped.parts.elements.num_lists());
}

/// Calls work(grouped) for all models of large strains that relax, in both ways.
template <class Work>
void for_each_relaxing(const Work& work) {
    for (const SolidModel& model : solid_models())
        for (const RelaxationOf which : {RelaxationOf::total, RelaxationOf::isochoric}) {
            SCOPED_TRACE(name_of(model));
            Grouped grouped(model);
            if (grouped.groups.is_empty() || model.materials.front().law == "linear") continue;
            grouped.relax(which);
            work(grouped);
        }
}

TEST(ElementGroups, AnswerInAViscousStepAsTheirElementsDo) {
    for_each_relaxing(expect_groups_as_elements);
}

TEST(ElementGroups, ChangesOfForcesAndOfWhatRelaxesAreThoseOfTheElements) {
    for_each_relaxing([](const Grouped& grouped) {
        const SolidModel& model = grouped.model;
        const std::size_t points = grouped.num_points();
        const std::size_t nodes = std::size_t(model.mesh.table().num_nodes);
        // by each parameter of the laws, by the factor and by what earlier steps left
        std::vector<SolidChange> changes;
        const std::size_t parameters = model.materials.front().parameters.size();
        for (std::size_t k = 0; k < parameters; ++k) {
            SolidChange& change = changes.emplace_back();
            for (const SolidMaterial& material : model.materials) {
                change.parameters.emplace_back(material.parameters.size(), 0.0);
                change.parameters.back()[k] = 1;
            }
        }
        changes.emplace_back().factor.assign(model.materials.size(), 1.0);
        changes.emplace_back().prestress = grouped.prestress;
        Eigen::MatrixXd du(model.num_dofs(), Eigen::Index(changes.size()));
        for (Eigen::Index c = 0; c < du.cols(); ++c)
            du.col(c) = double(c + 1) * grouped.u.reverse();
        if (model.mesh.formulation != Formulation::solid)
            for (Index n = 0; n < model.mesh.num_nodes(); ++n) du.row(3 * n + 2).setZero();

        for (Index g = 0; g < grouped.groups.first_of(grouped.parts.elements.num_lists()); ++g) {
            if (grouped.is_alone(g)) continue;
            std::vector<Pack> force;
            Tensor3<Pack> stress[most_element_points];
            std::vector<Tensor3<Pack>> stress_changes;
            ASSERT_TRUE(
                grouped.groups.force_changes(g, grouped.step(), grouped.u.data(), changes, force));
            ASSERT_TRUE(
                grouped.groups.relaxing_stress(g, grouped.step(), grouped.u.data(), stress));
            ASSERT_TRUE(grouped.groups.relaxing_stress_changes(g, grouped.step(), grouped.u.data(),
                                                               du, changes, stress_changes));
            int lane = 0;
            for (const Index e : grouped.groups.elements_of(g)) {
                std::vector<ElementChange> here;
                for (const SolidChange& change : changes) {
                    ElementChange& one = here.emplace_back();
                    const Index region = model.mesh.region[e];
                    if (!change.parameters.empty()) one.parameters = change.parameters[region];
                    if (!change.factor.empty()) one.factor = change.factor[region];
                    if (!change.prestress.empty())
                        one.prestress = grouped.of_element(change.prestress, e);
                }
                grouped.with_laws(e, [&](const auto& law_at) {
                    using Law = std::decay_t<decltype(law_at(std::size_t{0}))>;
                    std::array<Vec3, most_element_nodes> none;
                    none.fill(Vec3::Zero());
                    std::vector<std::array<Vec3, most_element_nodes>> alone(here.size(), none);
                    add_force_changes(grouped.model, law_at, grouped.points_of(e), grouped.u, here,
                                      alone);
                    for (std::size_t c = 0; c < here.size(); ++c)
                        EXPECT_LT(relative_error(&force[3 * nodes * c], alone[c][0].data(),
                                                 3 * nodes, lane),
                                  100 * rounding)
                            << "change " << c;
                    if constexpr (is_viscous_step<Law>) {
                        PointTensors h;
                        law_gradients(grouped.model, law_at, grouped.points_of(e), grouped.u, h);
                        for (std::size_t q = 0; q < points; ++q) {
                            const Law law = law_at(q);
                            const auto relaxing = law.relaxing_at(law.state(h[q])).stress;
                            const auto alone_stress = inverse_times<false>(h[q], relaxing);
                            EXPECT_LT(relative_error(stress[q].m, alone_stress.m, 9, lane),
                                      rounding);
                        }
                        relaxing_stress_changes(
                            grouped.model, law_at, grouped.points_of(e), grouped.u, du, here,
                            [&](std::size_t c, std::size_t q, const Tensor3<double>& change) {
                                EXPECT_LT(relative_error(stress_changes[c * points + q].m, change.m,
                                                         9, lane),
                                          100 * rounding)
                                    << "change " << c;
                            });
                    }
                });
                ++lane;
            }
        }
    });
}

TEST(ElementGroups, SayWhereMatterIsInverted) {
    for (const VolumeTreatment volume :
         {VolumeTreatment::pointwise, VolumeTreatment::element_mean}) {
        SolidModel model = solid_model(solid_meshes()[0], solid_materials()[1]);
        model.volume = volume;
        Grouped grouped(model);
        const auto num_invalid = [&] {
            Index count = 0;
            for (Index g = 0; g < grouped.groups.first_of(grouped.parts.elements.num_lists());
                 ++g) {
                Pack energy, force[3 * most_element_nodes];
                count += !grouped.is_alone(g) &&
                         !grouped.groups.force(g, grouped.step(), grouped.u.data(), energy, force);
            }
            return count;
        };
        EXPECT_EQ(num_invalid(), 0);
        grouped.u[2] = 5;  // a corner through the box
        EXPECT_GT(num_invalid(), 0);
    }
}

TEST(Pack, AComparisonHoldsForAllOrNot) {
    Pack a(1), b(2);
    EXPECT_TRUE(b > a && a < b && a == Pack(1.0));
    b.set(2, std::nan(""));
    EXPECT_FALSE(b > a);
    EXPECT_FALSE(a > b);
    b.set(2, 0);
    EXPECT_FALSE(b > a);
    EXPECT_FALSE(b < a);
    a.set(1, -3);
    EXPECT_EQ(fabs(a)[1], 3);
    EXPECT_EQ(fabs(a)[0], 1);
    for (int lane = 0; lane < Pack::size; ++lane) {
        EXPECT_EQ(expm1(a)[lane], std::expm1(a[lane]));
        EXPECT_EQ((2 * a - 1)[lane], 2 * a[lane] - 1);
    }
}

}  // namespace
}  // namespace palpate
