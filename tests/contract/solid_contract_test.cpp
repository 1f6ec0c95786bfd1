// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver/equilibrium/solid_assembly.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/columns.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"

// The element loops of every back end against those of the host, which its own tests hold to
// differences and closed forms.
namespace palpate {
namespace {

using namespace fixtures;

constexpr double double_tolerance = 1e-10;
constexpr double single_tolerance = 2e-5;  ///< fp32 rounds strains to 1e-6 of their size here

struct Case {
    std::string backend;
    Precision precision;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.backend; }

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const std::string& name : backend_names())
        for (const Precision precision : {Precision::single, Precision::double_})
            cases.push_back({name, precision});
    return cases;
}

std::string case_name(const testing::TestParamInfo<Case>& entry) {
    return entry.param.backend +
           (entry.param.precision == Precision::single ? "_single" : "_double");
}

bool is_plane(const SolidModel& model) { return model.mesh.formulation != Formulation::solid; }

bool is_supported(const SolidModel& model) {
    return model.mesh.formulation != Formulation::plane_stress;
}

/// Strains of about `size`, on top of a translation.
Eigen::VectorXd bent(const SolidModel& model, double size) {
    Eigen::VectorXd u(model.num_dofs());
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        u.segment<3>(3 * n) << 0.8 * x.x() + 0.3 * x.y() * x.y() + 0.1 * x.z() * x.x(),
            -0.5 * x.y() + 0.4 * std::sin(x.x()) + 0.3 * x.z() + 0.7,
            0.6 * x.z() + 0.2 * x.x() * x.y();
        if (is_plane(model)) u[3 * n + 2] = 0;
    }
    return size * u;
}

/// Any direction that the formulation allows.
Columns directions(const SolidModel& model, Index columns) {
    Columns x = random_columns(model.num_dofs(), columns, 7);
    if (is_plane(model))
        for (Index n = 0; n < model.mesh.num_nodes(); ++n) x.row(3 * n + 2).setZero();
    return x;
}

/// Every element and formulation with every law, and two with two materials: of one law, of two.
std::vector<SolidModel> models() {
    std::vector<SolidModel> list = solid_models();
    for (const std::size_t second : {1, 3}) {
        SolidModel model = solid_model(solid_meshes()[1], solid_materials()[1]);
        model.materials.push_back(solid_materials()[second]);
        model.materials[1].parameters[0] *= 3;
        for (std::size_t e = 0; e < model.mesh.region.size(); ++e)
            model.mesh.region[e] = e % 3 == 1;
        list.push_back(model);
    }
    // More elements than a work group, and no multiple of one.
    list.push_back(
        solid_model(solid_mesh_of(two_tissue_model({5, 4, 3}).mesh), solid_materials()[1]));
    list.back().materials.push_back(solid_materials()[4]);
    // Triangles about an axis, quadrilaterals in plane strain.
    for (const auto& [type, formulation] :
         {std::pair(ElementType::tri3, Formulation::axisymmetric),
          std::pair(ElementType::quad4, Formulation::plane_strain)})
        list.push_back(solid_model(rectangle_mesh(type, formulation, {3, 2}, {3.0, 2.0}),
                                   solid_materials()[2]));
    return list;
}

class SolidContract : public testing::TestWithParam<Case> {
protected:
    /// What the back end has loops for. OpenCL compiles each element and law for seconds: of mean
    /// volumes, where laws are asked the same questions by all loops, it shows one law of small
    /// strains and one not.
    std::vector<SolidModel> supported_models() const {
        std::vector<SolidModel> list;
        for (const SolidModel& model : models()) {
            const std::string& law = model.materials[0].law;
            const bool is_one_of_many = model.volume == VolumeTreatment::element_mean &&
                                        law != "linear" && law != "neo-hookean";
            if (is_supported(model) && !(is_one_of_many && GetParam().backend == "opencl"))
                list.push_back(model);
        }
        return list;
    }

    void SetUp() override {
        BackendOrReason tried = try_backend(GetParam().backend, {GetParam().precision, {}, ""});
        if (!tried.backend) GTEST_SKIP() << tried.reason;
        backend = std::move(tried.backend);
        tolerance = backend->describe().precision == Precision::double_ ? double_tolerance
                                                                        : single_tolerance;
    }

    static std::span<const double> span_of(const Eigen::VectorXd& v) {
        return {v.data(), static_cast<std::size_t>(v.size())};
    }

    Columns apply(SolidDevice& solid, const Columns& x) {
        const auto columns = static_cast<Index>(x.cols());
        const auto rows = static_cast<Index>(x.rows());
        const auto in = backend->make_vector(rows, columns),
                   out = backend->make_vector(rows, columns);
        backend->copy_in({x.data(), static_cast<std::size_t>(x.size())}, *in);
        solid.apply(*in, *out);
        Columns y(rows, columns);
        backend->copy_out(*out, {y.data(), static_cast<std::size_t>(y.size())});
        return y;
    }

    std::unique_ptr<Backend> backend;
    double tolerance = 0;
};

Columns times(const BlockMatrix& matrix, const Columns& x) {
    Columns y = Columns::Zero(x.rows(), x.cols());
    for (Index n = 0; n < matrix.num_rows(); ++n)
        for (Index k = matrix.graph.offsets[n]; k < matrix.graph.offsets[n + 1]; ++k)
            y.middleRows<3>(3 * n) +=
                Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrix.block(k)) *
                x.middleRows<3>(3 * matrix.graph.items[k]);
    return y;
}

/// Without the rows and columns of dofs that a plane does not have: a loop may leave them out.
BlockMatrix of_formulation(const SolidModel& model, BlockMatrix matrix) {
    for (std::size_t k = 0; k < matrix.blocks.size() && is_plane(model); ++k)
        if (k % 3 == 2 || k % 9 / 3 == 2) matrix.blocks[k] = 0;
    return matrix;
}

double norm_of(const std::vector<double>& values) {
    return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

TEST_P(SolidContract, ForcesAndEnergyAreThoseOfTheHost) {
    for (const SolidModel& model : supported_models()) {
        const SolidAssembly host(model);
        const auto solid = backend->make_solid(model);
        // At rest nothing may be left of fp32's rounding but in relation to the strain.
        for (const double size : {0.1, 1e-4}) {
            const Eigen::VectorXd u = bent(model, size);
            const InternalForce expected = host.internal_force(u);
            ASSERT_TRUE(expected.is_valid) << name_of(model);

            const SolidForce found = solid->internal_force(span_of(u));

            EXPECT_TRUE(found.is_valid);
            EXPECT_NEAR(found.energy, expected.energy, tolerance * expected.energy)
                << name_of(model) << size;
            const Eigen::Map<const Eigen::VectorXd> force(found.force.data(), u.size());
            EXPECT_LE((force - expected.force).norm(), tolerance * expected.force.norm())
                << name_of(model) << " strain " << size;
        }
    }
}

TEST_P(SolidContract, TangentIsThatOfTheHost) {
    for (const SolidModel& model : supported_models()) {
        const SolidAssembly host(model);
        const Eigen::VectorXd u = bent(model, 0.1);
        BlockMatrix expected = host.make_matrix(), found = host.make_matrix();
        host.tangent(u, expected);
        std::fill(found.blocks.begin(), found.blocks.end(), -1.0);

        backend->make_solid(model)->tangent(span_of(u), found);

        expected = of_formulation(model, expected);
        found = of_formulation(model, found);
        EXPECT_LE(distance(found.blocks, expected.blocks), tolerance * norm_of(expected.blocks))
            << name_of(model);
    }
}

TEST_P(SolidContract, ProductIsThatOfTheTangentForAnyNumberOfColumns) {
    for (const SolidModel& model : supported_models()) {
        const SolidAssembly host(model);
        const Eigen::VectorXd u = bent(model, 0.1);
        BlockMatrix matrix = host.make_matrix();
        host.tangent(u, matrix);
        const auto solid = backend->make_solid(model);
        solid->linearise(span_of(u));
        for (const Index columns : {1, 7, 19}) {
            const Columns x = directions(model, columns);
            const Columns expected = times(matrix, x);

            const Columns found = apply(*solid, x);

            EXPECT_LE((found - expected).norm(), tolerance * expected.norm())
                << name_of(model) << ", " << columns << " columns";
        }
    }
}

TEST_P(SolidContract, ParameterProductsAreThoseOfTheHost) {
    for (const SolidModel& model : supported_models()) {
        const SolidAssembly host(model);
        const Eigen::VectorXd u = bent(model, 0.1), lambda = bent(model, 0.3).array().sin();
        const auto expected = host.parameter_products(u, lambda);
        const double force = host.internal_force(u).force.norm() * lambda.norm();

        const auto found =
            backend->make_solid(model)->parameter_products(span_of(u), span_of(lambda));

        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t m = 0; m < expected.size(); ++m) {
            ASSERT_EQ(found[m].size(), expected[m].size());
            for (std::size_t k = 0; k < expected[m].size(); ++k)
                // In relation to what a change of the parameter by its own size could do.
                EXPECT_NEAR(found[m][k], expected[m][k],
                            tolerance * std::max(std::abs(expected[m][k]),
                                                 force / model.materials[m].parameters[k]))
                    << name_of(model) << ", parameter " << k;
        }
    }
}

TEST_P(SolidContract, InvertedMatterIsNotValidAndAddsNothing) {
    for (const SolidModel& model : supported_models()) {
        if (is_plane(model) || model.materials[0].law == "linear") continue;
        const SolidAssembly host(model);
        Eigen::VectorXd u = Eigen::VectorXd::Zero(model.num_dofs());
        u[2] = 2.5 * model.mesh.nodes.back().z();  // a corner through the box
        BlockMatrix expected = host.make_matrix(), found = host.make_matrix();
        host.tangent(u, expected);
        const auto solid = backend->make_solid(model);

        const SolidForce force = solid->internal_force(span_of(u));
        solid->tangent(span_of(u), found);

        EXPECT_FALSE(force.is_valid);
        EXPECT_TRUE(std::isinf(force.energy));
        EXPECT_LE(distance(found.blocks, expected.blocks), tolerance * norm_of(expected.blocks))
            << name_of(model);
        solid->linearise(span_of(u));
        const Columns x = directions(model, 3), product = times(expected, x);
        EXPECT_LE((apply(*solid, x) - product).norm(), tolerance * product.norm())
            << name_of(model);
    }
}

TEST_P(SolidContract, SameBitsEveryTime) {
    const SolidModel model =
        solid_model(solid_mesh_of(box_mesh({6, 5, 4}, Vec3(6, 5, 4))), solid_materials()[1]);
    const Eigen::VectorXd u = bent(model, 0.02);
    const auto solid = backend->make_solid(model);

    const SolidForce first = solid->internal_force(span_of(u));
    const SolidForce second = solid->internal_force(span_of(u));

    EXPECT_EQ(first.force, second.force);
    EXPECT_EQ(first.energy, second.energy);
}

TEST_P(SolidContract, WhatItHasNoLoopsForIsRefusedByName) {
    for (const SolidModel& model : solid_models()) {
        if (is_supported(model)) continue;
        try {
            backend->make_solid(model);
            FAIL() << name_of(model);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::unsupported);
            EXPECT_NE(std::string(error.what()).find(GetParam().backend), std::string::npos);
            EXPECT_NE(std::string(error.what()).find("make_solid"), std::string::npos);
        }
    }
}

TEST_P(SolidContract, ArgumentsThatDoNotFitAreRefused) {
    class ForeignVector final : public DeviceVector {
        using DeviceVector::DeviceVector;
    };
    const SolidModel model = solid_model(solid_meshes()[0], solid_materials()[1]);
    const auto solid = backend->make_solid(model);
    const Eigen::VectorXd u = bent(model, 0.1), shorter = u.head(u.size() - 1);
    BlockMatrix flat = SolidAssembly(model).make_matrix(), other_rows = flat, fewer = flat;
    flat.block_rows = 1;
    flat.block_columns = 9;
    ++other_rows.graph.offsets[1];
    fewer.blocks.resize(fewer.blocks.size() - 9);
    BlockMatrix empty;
    const auto x = backend->make_vector(model.num_dofs(), 1),
               y = backend->make_vector(model.num_dofs(), 1);
    ForeignVector foreign(model.num_dofs(), 1);
    const auto refuses = [](const auto& call) {
        return code_of(call) == ErrorCode::invalid_argument;
    };

    EXPECT_TRUE(refuses([&] { solid->internal_force(span_of(shorter)); }));
    EXPECT_TRUE(refuses([&] { solid->linearise(span_of(shorter)); }));
    EXPECT_TRUE(refuses([&] { solid->apply(*x, *y); })) << "not linearised";
    BlockMatrix good = SolidAssembly(model).make_matrix();
    EXPECT_TRUE(refuses([&] { solid->tangent(span_of(shorter), good); }));
    for (BlockMatrix* matrix : {&empty, &flat, &other_rows, &fewer})
        EXPECT_TRUE(refuses([&] { solid->tangent(span_of(u), *matrix); }));
    EXPECT_TRUE(refuses([&] { solid->parameter_products(span_of(u), span_of(shorter)); }));
    EXPECT_TRUE(refuses([&] { solid->parameter_products(span_of(shorter), span_of(u)); }));
    solid->linearise(span_of(u));
    EXPECT_TRUE(refuses([&] { solid->apply(*x, *backend->make_vector(3, 1)); }));
    EXPECT_TRUE(refuses([&] { solid->apply(*x, *backend->make_vector(x->rows(), 2)); }));
    EXPECT_TRUE(refuses([&] { solid->apply(*backend->make_vector(3, 1), *y); }));
    EXPECT_TRUE(refuses([&] { solid->apply(*x, *x); }));
    EXPECT_TRUE(refuses([&] { solid->apply(foreign, *y); }));
    EXPECT_TRUE(refuses([&] { solid->apply(*x, foreign); }));
}

INSTANTIATE_TEST_SUITE_P(EveryBackend, SolidContract, testing::ValuesIn(every_case()), case_name);

}  // namespace
}  // namespace palpate
