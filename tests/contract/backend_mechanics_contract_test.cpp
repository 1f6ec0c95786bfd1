// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "tests/contract/backend_contract.hpp"

// Stiffness, forces and energies of the prepared model.
namespace palpate::backend_contract {
namespace {

TEST_P(BackendContract, ComputesTheMechanicsOfAModel) {
    prepare(odd_model());

    expect_same_mechanics(30);
    expect_right_sums(backend_->stiffness(), 60);
}

TEST_P(BackendContract, WorksOnASingleElement) {
    Mesh mesh;
    mesh.nodes = {{0, 0, 0}, {10, 0, 1}, {0, 12, 0}, {1, 0, 9}};
    mesh.tets = {{0, 1, 2, 3}};
    mesh.region = {0};
    Model model = fixtures::free_model(mesh, {{25.0, 0.3}});
    fixtures::prescribe(model, {2});
    prepare(model);

    expect_same_mechanics(70);
    expect_right_sums(backend_->stiffness(), 100);
}

TEST_P(BackendContract, GivesANodeOfNoElementNoStiffness) {
    Model model = fixtures::two_tissue_model({2, 2, 2});
    model.mesh.nodes.insert(model.mesh.nodes.end(), {{99, 99, 99}, {98, 99, 99}});
    model.prescribed.insert(model.prescribed.end(), {0, 0, 0, 1, 1, 1});
    prepare(model);

    expect_same_mechanics(110);
}

TEST_P(BackendContract, GivesNoForceForARigidMotion) {
    prepare(odd_model());
    const auto force_of = [&](const Columns& x) {
        const auto y = backend_->make_vector(model_.num_dofs(), static_cast<Index>(x.cols()));
        backend_->internal_force(*to_device(*backend_, x), *y);
        return to_host(*backend_, *y);
    };
    for (Index columns : column_counts) {
        Columns x(model_.num_dofs(), columns);
        for (Index n = 0; n < model_.mesh.num_nodes(); ++n)
            for (Index c = 0; c < x.cols(); ++c)
                x.block<3, 1>(3 * n, c) =
                    Vec3(1, -2, 0.5) + 0.01 * Vec3(1 + c, 2, -1).cross(model_.mesh.nodes[n]);
        const double scale = force_of(random_state(columns, 140)).norm();

        EXPECT_LT(force_of(x).norm(), tolerance() * x.cwiseAbs().maxCoeff() * scale);
    }
}

TEST_P(BackendContract, ComputesTheStrainEnergy) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_state(columns, 141);
        std::vector<double> expected(columns), actual(columns);

        oracle_->strain_energy(*to_device(*oracle_, x), expected);
        backend_->strain_energy(*to_device(*backend_, x), actual);

        expect_close(actual, expected);
    }
}

TEST_P(BackendContract, DifferentiatesWithRespectToTheModuli) {
    prepare(odd_model());
    for (Index columns : column_counts) {
        const Columns x = random_state(columns, 142);
        const Columns lambda = x + 0.7 * random_state(columns, 143);
        std::vector<double> expected(2), actual(2);

        oracle_->parameter_gradient(*to_device(*oracle_, lambda), *to_device(*oracle_, x),
                                    expected);
        backend_->parameter_gradient(*to_device(*backend_, lambda), *to_device(*backend_, x),
                                     actual);

        expect_close(actual, expected);
    }
}

TEST_P(BackendContract, DifferentiatesTheEnergyOfOneVector) {
    prepare(odd_model());
    const Columns x = random_state(3, 145);
    const auto on_device = to_device(*backend_, x), of_oracle = to_device(*oracle_, x);
    std::vector<double> expected(2), actual(2);

    oracle_->parameter_gradient(*of_oracle, *of_oracle, expected);
    backend_->parameter_gradient(*on_device, *on_device, actual);

    expect_close(actual, expected);
}

TEST_P(BackendContract, TakesNewModuliForThePreparedModel) {
    prepare(odd_model());
    const auto x = to_device(*backend_, random_state(3, 144));
    const auto y = backend_->make_vector(model_.num_dofs(), 3);
    backend_->apply(backend_->stiffness(), *x, *y);

    const std::vector<double> moduli = {3.0, 410.0};
    backend_->set_stiffness(moduli);
    oracle_->set_stiffness(moduli);

    expect_same_mechanics(150);
}

TEST_P(BackendContract, TakesAnotherModel) {
    prepare(odd_model());
    expect_same_mechanics(180);

    prepare(fixtures::two_tissue_model({3, 3, 4}));

    expect_same_mechanics(210);
}

TEST_P(BackendContract, RepeatsItsResultsBitForBit) {
    prepare(odd_model());
    const auto run = [&](Index columns) {
        const DeviceOperator& a = backend_->stiffness();
        const auto x = to_device(*backend_, random_state(columns, 300));
        const auto y = nan_vector(*backend_, a.rows(), columns);
        const auto z = nan_vector(*backend_, a.rows(), columns);
        const auto xy = backend_->make_sums(columns), zy = backend_->make_sums(columns);
        backend_->apply(a, *x, *y, xy.get());
        backend_->smooth(a, *y, *x, 1, 0, 0.5, *z, zy.get());
        std::vector<double> results = numbers_of(*backend_, *xy);
        for (double number : numbers_of(*backend_, *zy)) results.push_back(number);
        const std::size_t num_sums = results.size();
        results.resize(num_sums + columns + model_.materials.size());
        backend_->strain_energy(*x, std::span(results).subspan(num_sums, columns));
        backend_->parameter_gradient(*y, *x, std::span(results).subspan(num_sums + columns));
        const Columns values = to_host(*backend_, *z);
        results.insert(results.end(), values.data(), values.data() + values.size());
        return results;
    };

    for (Index columns : column_counts) EXPECT_EQ(run(columns), run(columns));
}

}  // namespace
}  // namespace palpate::backend_contract
