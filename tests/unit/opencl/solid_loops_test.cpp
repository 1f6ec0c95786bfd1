// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "solver/backends/opencl/opencl_backend.hpp"
#include "solver/base/error.hpp"
#include "tests/fixtures/meshes.hpp"
#include "tests/fixtures/solid_models.hpp"
#include "tests/unit/opencl/gpu_layout.hpp"

// The contract test holds the layout for the device at hand; here is the one for GPUs.
namespace palpate {
namespace {

using namespace fixtures;

constexpr double rounding = 1e-12;

struct Results {
    SolidForce force;
    BlockMatrix tangent;
    std::vector<double> product;
    std::vector<std::vector<double>> parameters;
};

Results results_of(Backend& backend, const SolidModel& model) {
    constexpr Index columns = 5;
    std::vector<double> u, x;
    for (Index d = 0; d < model.num_dofs(); ++d) {
        const bool is_free = !model.prescribed[d];
        u.push_back(is_free ? 0.05 * std::sin(0.9 * d) : 0);
        for (Index c = 0; c < columns; ++c) x.push_back(is_free ? std::cos(1.3 * d + c) : 0);
    }
    const auto solid = backend.make_solid(model);
    Results results;
    results.force = solid->internal_force(u);
    results.tangent.graph = node_graph(model.mesh);
    results.tangent.num_columns = model.mesh.num_nodes();
    results.tangent.blocks.assign(9 * results.tangent.graph.items.size(), -1.0);
    solid->tangent(u, results.tangent);
    results.parameters = solid->parameter_products(u, results.force.force);
    const auto in = backend.make_vector(model.num_dofs(), columns),
               out = backend.make_vector(model.num_dofs(), columns);
    backend.copy_in(x, *in);
    solid->linearise(u);
    solid->apply(*in, *out);
    results.product.resize(x.size());
    backend.copy_out(*out, results.product);
    return results;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected,
                 const char* what) {
    ASSERT_EQ(found.size(), expected.size());
    double largest = 0, worst = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        largest = std::max(largest, std::abs(expected[i]));
        worst = std::max(worst, std::abs(found[i] - expected[i]));
    }
    EXPECT_GT(largest, 0) << what;
    EXPECT_LE(worst, rounding * largest) << what;
}

TEST(SolidLoops, GiveInTheLayoutForGpusWhatTheyGiveOnACpu) {
    const BackendOptions options{Precision::double_, {}, ""};
    std::unique_ptr<Backend> cpu, gpu;
    try {
        cpu = make_opencl_backend(options);
        gpu = make_opencl_backend_on(open_as_gpu(), options);
    } catch (const Error& error) {
        GTEST_SKIP() << error.what();
    }
    for (const std::size_t mesh : {1, 4}) {  // tet10, quad4 about an axis
        SolidModel model = solid_model(solid_meshes()[mesh], solid_materials()[1]);
        model.materials.push_back(solid_materials()[3]);
        for (std::size_t e = 0; e < model.mesh.region.size(); ++e) model.mesh.region[e] = e % 2;

        const Results expected = results_of(*cpu, model), found = results_of(*gpu, model);

        EXPECT_TRUE(expected.force.is_valid);
        EXPECT_NEAR(found.force.energy, expected.force.energy, rounding * expected.force.energy);
        expect_near(found.force.force, expected.force.force, "force");
        expect_near(found.tangent.blocks, expected.tangent.blocks, "tangent");
        expect_near(found.product, expected.product, "product");
        for (std::size_t m = 0; m < 2; ++m)
            expect_near(found.parameters[m], expected.parameters[m], "parameters");
    }
}

}  // namespace
}  // namespace palpate
