// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/opencl_backend.hpp"
#include "solver/backends/opencl/opencl_devices.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "solver/base/error.hpp"
#include "tests/fixtures/backends.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/unit/opencl/gpu_layout.hpp"
#include "tests/unit/opencl/host_loops.hpp"

namespace palpate {
namespace {

using host_loops::Columns;
using host_loops::random_columns;
using host_loops::relative_difference;

// Relative to the largest entry: some ten roundings of products that partly cancel.
double tolerance_of(Precision precision) { return precision == Precision::double_ ? 1e-13 : 3e-6; }

struct Setup {
    Precision precision;
    Product product;
    Index columns;
    bool as_gpu;  ///< the kernels' layout for GPUs, run on whatever device there is
};

std::string name_of(const testing::TestParamInfo<Setup>& info) {
    return std::string(info.param.precision == Precision::double_ ? "Double" : "Single") +
           (info.param.product == Product::assembled     ? "Assembled"
            : info.param.product == Product::matrix_free ? "MatrixFree"
                                                         : "Recomputed") +
           (info.param.as_gpu ? "AsGpu" : "") + std::to_string(info.param.columns) + "Columns";
}

std::vector<Setup> all_setups() {
    std::vector<Setup> setups;
    for (Precision precision : {Precision::single, Precision::double_})
        for (Product product : {Product::assembled, Product::matrix_free, Product::recomputed})
            for (Index columns : {1, 3, 16, 33})
                for (bool as_gpu : {false, true})
                    if (!as_gpu ||
                        (precision == Precision::single && (columns == 1 || columns == 33)))
                        setups.push_back({precision, product, columns, as_gpu});
    return setups;
}

std::shared_ptr<OpenclDevice> device_of(const Setup& setup) {
    return setup.as_gpu ? open_as_gpu() : open_device("");
}

BackendOptions options_of(const Setup& setup) {
    BackendOptions options;
    options.precision = setup.precision;
    options.product = setup.product;
    return options;
}

Columns out_of(Backend& backend, const DeviceVector& v) {
    Columns host(v.rows(), v.columns());
    backend.copy_out(v, {host.data(), static_cast<std::size_t>(host.size())});
    return host;
}

std::unique_ptr<DeviceVector> into(Backend& backend, const Columns& host) {
    auto v = backend.make_vector(static_cast<Index>(host.rows()), static_cast<Index>(host.cols()));
    backend.copy_in({host.data(), static_cast<std::size_t>(host.size())}, *v);
    return v;
}

class OpenclBackendTest : public testing::TestWithParam<Setup> {
protected:
    void SetUp() override {
        try {
            static std::map<bool, std::shared_ptr<OpenclDevice>> devices;  // programs built once
            std::shared_ptr<OpenclDevice>& device = devices[GetParam().as_gpu];
            if (!device) device = device_of(GetParam());
            backend = make_opencl_backend_on(device, options_of(GetParam()));
        } catch (const Error& error) {
            if (error.code() != ErrorCode::device_unavailable &&
                error.code() != ErrorCode::unsupported)
                throw;
            GTEST_SKIP() << error.what();
        }
    }

    std::unique_ptr<DeviceVector> random_vector(Index rows, unsigned seed) {
        return into(*backend, random_columns(rows, GetParam().columns, seed));
    }
    std::unique_ptr<DeviceVector> nan_vector(Index rows) {
        auto v = backend->make_vector(rows, GetParam().columns);
        backend->fill(*v, std::numeric_limits<double>::quiet_NaN());
        return v;
    }
    void expect_close(const DeviceVector& actual, const Columns& expected) {
        EXPECT_LE(relative_difference(out_of(*backend, actual), expected),
                  tolerance_of(GetParam().precision));
    }

    void expect_products(const Model& model, const std::vector<double>& moduli, unsigned seed) {
        const Columns x = random_columns(model.num_dofs(), GetParam().columns, seed);
        const auto device_x = into(*backend, x);
        const auto y = nan_vector(model.num_dofs());

        backend->internal_force(*device_x, *y);
        expect_close(*y, host_loops::internal_force(model, moduli, x));
        backend->apply(backend->stiffness(), *device_x, *y);
        expect_close(*y, host_loops::constrained_product(model, moduli, x));
        backend->apply_inverse_diagonal(backend->stiffness(), 1.0, *device_x, *y);
        expect_close(*y, host_loops::block_jacobi(model, moduli, x));
    }
    std::unique_ptr<DeviceSums> sums_of(const std::vector<double>& values) {
        auto sums = backend->make_sums(GetParam().columns);
        backend->set(*sums, values);
        return sums;
    }
    std::vector<double> numbers_of(const DeviceSums& sums) {
        std::vector<double> values(GetParam().columns);
        backend->read(sums, values);
        return values;
    }

    std::unique_ptr<Backend> backend;
};

INSTANTIATE_TEST_SUITE_P(Setups, OpenclBackendTest, testing::ValuesIn(all_setups()), name_of);

// 60 nodes: less than a work group; 720 nodes: no multiple of one.
const std::array<Index, 3> mesh_sizes[] = {{2, 3, 4}, {9, 8, 7}};

TEST_P(OpenclBackendTest, ProductsMatchPlainLoopsOnHost) {
    for (const auto& cubes : mesh_sizes) {
        const Model model = fixtures::two_tissue_model(cubes);
        backend->prepare(model);

        expect_products(model, host_loops::moduli_of(model), 1);
    }
}

TEST_P(OpenclBackendTest, NewStiffnessRescalesEveryOperation) {
    const Model model = fixtures::two_tissue_model({4, 3, 5});
    const std::vector<double> moduli = {7.5, 0.25};
    ASSERT_EQ(model.materials.size(), moduli.size());
    backend->prepare(model);

    backend->set_stiffness(moduli);

    expect_products(model, moduli, 2);
}

TEST_P(OpenclBackendTest, EnergyAndParameterGradientMatchPlainLoopsOnHost) {
    const Model model = fixtures::two_tissue_model({9, 8, 7});
    const Columns x = random_columns(model.num_dofs(), GetParam().columns, 3);
    const Columns lambda = random_columns(model.num_dofs(), GetParam().columns, 4);
    backend->prepare(model);
    const auto device_x = into(*backend, x);
    const auto device_lambda = into(*backend, lambda);
    std::vector<double> energy(GetParam().columns);
    std::vector<double> gradient(2);

    backend->strain_energy(*device_x, energy);
    backend->parameter_gradient(*device_lambda, *device_x, gradient);

    const Columns force = host_loops::internal_force(model, host_loops::moduli_of(model), x);
    for (Index c = 0; c < GetParam().columns; ++c) {
        const double expected = 0.5 * x.col(c).dot(force.col(c));
        EXPECT_NEAR(energy[c], expected, 1e-6 * expected);
    }
    const std::vector<double> units[] = {{1, 0}, {0, 1}};
    for (int region = 0; region < 2; ++region) {
        const Columns unit_force = host_loops::internal_force(model, units[region], x);
        const double expected = (lambda.array() * unit_force.array()).sum();
        const double size = lambda.norm() * unit_force.norm();
        EXPECT_NEAR(gradient[region], expected, tolerance_of(GetParam().precision) * size);
    }
}

TEST_P(OpenclBackendTest, AStepOfConjugateGradientsMatchesHostColumnByColumn) {
    const Index rows = 1237;
    const Index columns = GetParam().columns;
    const Columns p = random_columns(rows, columns, 5), q = random_columns(rows, columns, 6);
    const Columns x = random_columns(rows, columns, 7), r = random_columns(rows, columns, 8);
    std::vector<double> rz(columns), pq(columns), rr(columns, 1.0), limit(columns);
    for (Index c = 0; c < columns; ++c) {
        rz[c] = 0.5 + c;
        pq[c] = c % 4 == 1 ? -1.0 : 2.0 + c;
        limit[c] = c % 4 == 2 ? 1.0 : 0.5;
    }
    const auto device_p = into(*backend, p);
    const auto device_x = into(*backend, x);
    const auto device_r = into(*backend, r);
    const auto rr_new = backend->make_sums(columns);

    backend->advance(*sums_of(rz), *sums_of(pq), *sums_of(rr), *sums_of(limit), *device_p,
                     *into(*backend, q), *device_x, *device_r, *rr_new);
    backend->turn(*sums_of(rz), *sums_of(pq), *device_r, *device_p);

    Columns expected_x = x, expected_r = r, expected_p(rows, columns);
    for (Index c = 0; c < columns; ++c) {
        const double step = c % 4 == 1 || c % 4 == 2 ? 0.0 : rz[c] / pq[c];
        expected_x.col(c) += step * p.col(c);
        expected_r.col(c) -= step * q.col(c);
        expected_p.col(c) = expected_r.col(c);
        if (pq[c] > 0) expected_p.col(c) += rz[c] / pq[c] * p.col(c);
    }
    expect_close(*device_x, expected_x);
    expect_close(*device_r, expected_r);
    expect_close(*device_p, expected_p);
    const std::vector<double> sums = numbers_of(*rr_new);
    for (Index c = 0; c < columns; ++c)
        EXPECT_NEAR(sums[c], expected_r.col(c).squaredNorm(),
                    1e-6 * expected_r.col(c).squaredNorm());
}

TEST_P(OpenclBackendTest, NodeWithoutElementsCountsAsZeroStiffness) {
    Model model = fixtures::two_tissue_model({2, 2, 2});
    model.mesh.nodes.push_back(Vec3(99, 99, 99));
    model.prescribed.insert(model.prescribed.end(), {1, 1, 0});
    const Columns x = random_columns(model.num_dofs(), GetParam().columns, 9);
    backend->prepare(model);
    const auto device_x = into(*backend, x);
    const auto y = nan_vector(model.num_dofs());

    backend->apply(backend->stiffness(), *device_x, *y);

    expect_close(*y, host_loops::constrained_product(model, host_loops::moduli_of(model), x));
}

TEST_P(OpenclBackendTest, VectorsOfAnotherBackendAreRefused) {
    const auto other = make_opencl_backend(options_of(GetParam()));
    const auto foreign = other->make_vector(3, 1);

    EXPECT_THROW(backend->fill(*foreign, 0), Error);
}

TEST_P(OpenclBackendTest, TooLargeVectorSaysThatMemoryRanOut) {
    try {
        backend->make_vector(std::numeric_limits<Index>::max(), 1 << 20);
        FAIL() << "8 PiB were allocated";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::out_of_memory);
    }
}

TEST(OpenclVectorTest, FreshVectorIsNanInDebugBuilds) {
#ifdef NDEBUG
    GTEST_SKIP() << "This is not a debug build.";
#endif
    if (opencl_devices().empty()) GTEST_SKIP() << "This machine has no OpenCL device.";
    const auto backend = make_opencl_backend({});

    const auto fresh = backend->make_vector(7, 5);

    EXPECT_TRUE(out_of(*backend, *fresh).array().isNaN().all());
}

}  // namespace
}  // namespace palpate
