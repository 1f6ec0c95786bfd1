// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <functional>

#include "tests/contract/backend_contract.hpp"

// What a back end refuses: Error(invalid_argument) from every one of them.
namespace palpate::backend_contract {
namespace {

TEST_P(BackendContract, RefusesColumnsThatDoNotExist) {
    const auto small = to_device(*backend_, random_columns(30, 2, 7));
    const auto large = to_device(*backend_, random_columns(30, 4, 8));
    const auto longer = to_device(*backend_, random_columns(31, 4, 9));
    const auto copy = [&](DeviceVector& to, std::vector<Index> from_columns,
                          std::vector<Index> to_columns) {
        return code_of([&] { backend_->copy_columns(*small, from_columns, to, to_columns); });
    };

    EXPECT_EQ(copy(*large, {2}, {0}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {0, 1}, {0, 4}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {-1}, {0}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {0}, {-1}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*large, {0, 1}, {0}), ErrorCode::invalid_argument);
    EXPECT_EQ(copy(*longer, {0}, {0}), ErrorCode::invalid_argument);
}

TEST_P(BackendContract, RefusesAMatrixThatDoesNotFitTheOperator) {
    const BlockMatrix matrix = random_matrix(23, 23, 3, 3, 291);
    const std::vector<double> diagonal = random_diagonal(matrix, 292);
    const auto a = backend_->make_operator(matrix, diagonal);
    const auto bare = backend_->make_operator(matrix, {});
    const auto x = to_device(*backend_, random_columns(69, 2, 293));
    const auto y = backend_->make_vector(69, 2), narrow = backend_->make_vector(69, 1);
    const auto shorter = backend_->make_vector(66, 2);
    const BlockMatrix wider = random_matrix(23, 24, 3, 3, 294);
    const std::vector<std::function<void()>> calls = {
        [&] { backend_->set_values(*a, wider, {}); },
        [&] { backend_->set_values(*a, random_matrix(22, 23, 3, 3, 295), {}); },
        [&] { backend_->set_values(*a, matrix, std::span(diagonal).first(9)); },
        [&] { backend_->make_operator(matrix, std::span(diagonal).first(9)); },
        [&] { backend_->apply_inverse_diagonal(*bare, 1, *x, *y); },
        [&] { backend_->smooth(*bare, *x, *x, 1, 0, 1, *y); },
        [&] { backend_->apply(*a, *x, *narrow); },
        [&] { backend_->apply(*a, *shorter, *y); },
        [&] { backend_->apply(*a, *x, *shorter); },
        [&] { backend_->apply(*a, *y, *y); },
        [&] { backend_->apply_add(*a, *x, *shorter); },
        [&] { backend_->apply_add(*a, *y, *y); },
        [&] { backend_->residual(*a, *shorter, *x, *y); },
        [&] { backend_->residual(*a, *x, *y, *y); },
        [&] { backend_->smooth(*a, *shorter, *x, 1, 0, 1, *y); },
        [&] { backend_->smooth(*a, *x, *y, 1, 0, 1, *y); },
        [&] { backend_->apply_inverse_diagonal(*a, 1, *shorter, *shorter); },
    };

    for (std::size_t i = 0; i < calls.size(); ++i)
        EXPECT_EQ(code_of(calls[i]), ErrorCode::invalid_argument) << "call " << i;
}

TEST_P(BackendContract, RefusesSizesThatDoNotMatch) {
    prepare(odd_model());
    const DeviceOperator& stiffness = backend_->stiffness();
    for (Index columns : column_counts) {
        const auto state = to_device(*backend_, random_state(columns, 310));
        const auto small = to_device(*backend_, random_columns(30, columns, 311));
        const auto large = backend_->make_vector(33, columns);
        const auto sums = backend_->make_sums(columns), other = backend_->make_sums(columns);
        const auto wide = backend_->make_sums(columns + 1);
        backend_->set(*sums, std::vector<double>(columns, 1.0));
        std::vector<double> many(columns + 1);
        const auto advance = [&](const DeviceSums& rz, const DeviceVector& p, DeviceSums& rr_new) {
            const auto x = backend_->make_vector(30, columns);
            backend_->advance(rz, *sums, *sums, *sums, p, *small, *x, *x, rr_new);
        };
        const std::vector<std::function<void()>> calls = {
            [&] { backend_->make_vector(-1, columns); },
            [&] { backend_->make_vector(3, 0); },
            [&] { backend_->make_sums(0); },
            [&] { backend_->copy_in(many, *large); },
            [&] { backend_->copy_out(*large, many); },
            [&] { backend_->set(*sums, many); },
            [&] { backend_->read(*sums, many); },
            [&] { backend_->dot(*small, *large, *sums); },
            [&] { backend_->dot(*small, *small, *wide); },
            [&] { advance(*wide, *small, *other); },
            [&] { advance(*sums, *large, *other); },
            [&] { advance(*sums, *small, *sums); },
            [&] { backend_->turn(*sums, *sums, *small, *large); },
            [&] { backend_->turn(*wide, *sums, *small, *small); },
            [&] { backend_->apply(stiffness, *small, *large); },
            [&] { backend_->apply(stiffness, *state, *state); },
            [&] { backend_->apply_inverse_diagonal(stiffness, 1, *small, *large); },
            [&] { backend_->internal_force(*small, *large); },
            [&] { backend_->internal_force(*state, *state); },
            [&] { backend_->strain_energy(*small, std::span(many).first(columns)); },
            [&] { backend_->strain_energy(*state, many); },
            [&] { backend_->parameter_gradient(*small, *large, std::span(many).first(1)); },
            [&] { backend_->set_stiffness(std::vector<double>{1.0}); },
            [&] {
                backend_->set_stiffness(std::vector<double>{1.0, 0.0});
            },
        };

        for (std::size_t i = 0; i < calls.size(); ++i)
            EXPECT_EQ(code_of(calls[i]), ErrorCode::invalid_argument) << "call " << i;
    }
}

TEST_P(BackendContract, WantsAModelBeforeItGivesItsStiffness) {
    EXPECT_EQ(code_of([&] { backend_->stiffness(); }), ErrorCode::invalid_argument);
}

TEST_P(BackendContract, RefusesAModelThatIsNotValid) {
    Model model = odd_model();
    std::swap(model.mesh.tets[5][0], model.mesh.tets[5][1]);

    EXPECT_EQ(code_of([&] { backend_->prepare(model); }), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate::backend_contract
