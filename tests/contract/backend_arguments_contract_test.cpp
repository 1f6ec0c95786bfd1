// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <functional>

#include "tests/contract/backend_contract.hpp"

// What a back end refuses: Error(invalid_argument) from every one of them.
namespace palpate::backend_contract {
namespace {

using Calls = std::vector<std::function<void()>>;

void expect_refused(const Calls& calls) {
    for (std::size_t i = 0; i < calls.size(); ++i)
        EXPECT_EQ(code_of(calls[i]), ErrorCode::invalid_argument) << "call " << i;
}

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
    const auto wide = backend_->make_sums(3);
    const BlockMatrix wider = random_matrix(23, 24, 3, 3, 294);
    const auto broad = backend_->make_operator(wider, {});
    const auto longer = to_device(*backend_, random_columns(72, 2, 297));
    const auto sums = backend_->make_sums(2);
    BlockMatrix one_block_less = matrix;
    one_block_less.graph.items.pop_back();
    one_block_less.graph.offsets.back() -= 1;
    one_block_less.blocks.resize(matrix.blocks.size() - 9);
    const Calls calls = {
        [&] { backend_->set_values(*a, wider, {}); },
        [&] { backend_->set_values(*a, random_matrix(22, 23, 3, 3, 295), {}); },
        [&] { backend_->set_values(*a, matrix, {}); },
        [&] { backend_->set_values(*bare, matrix, diagonal); },
        [&] { backend_->set_values(*bare, one_block_less, {}); },
        [&] { backend_->set_values(*bare, random_matrix(69, 69, 1, 1, 296), {}); },
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
        [&] { backend_->residual(*a, *y, *x, *y); },
        [&] { backend_->smooth(*a, *y, *x, 1, 0, 1, *y); },
        [&] { backend_->apply(*a, *x, *y, wide.get()); },
        [&] { backend_->smooth(*a, *x, *x, 1, 0, 1, *y, wide.get()); },
        [&] { backend_->apply_inverse_diagonal(*a, 1, *x, *y, wide.get()); },
        [&] { backend_->apply(*broad, *longer, *y, sums.get()); },
    };

    expect_refused(calls);
}

TEST_P(BackendContract, RefusesAMatrixThatDoesNotFitTogether) {
    const BlockMatrix sound = random_matrix(11, 11, 3, 3, 298);
    const std::vector<std::function<void(BlockMatrix&)>> faults = {
        [](BlockMatrix& m) { m.block_rows = 0; },
        [](BlockMatrix& m) { m.block_columns = max_block + 1; },
        [](BlockMatrix& m) { m.block_columns = 2; },
        [](BlockMatrix& m) { m.blocks.pop_back(); },
        [](BlockMatrix& m) { m.graph.items.pop_back(); },
        [](BlockMatrix& m) { m.graph.items.front() = -1; },
        [](BlockMatrix& m) { m.graph.items.back() = m.num_columns; },
        [](BlockMatrix& m) { m.graph.offsets.front() = 1; },
        [](BlockMatrix& m) { m.graph.offsets[1] = m.graph.offsets[2] + 1; },
        [](BlockMatrix& m) { m.graph.offsets.clear(); },
    };
    const auto a = backend_->make_operator(sound, {});
    for (std::size_t i = 0; i < faults.size(); ++i) {
        BlockMatrix matrix = sound;
        faults[i](matrix);

        EXPECT_EQ(code_of([&] { backend_->make_operator(matrix, {}); }),
                  ErrorCode::invalid_argument)
            << "fault " << i;
        EXPECT_EQ(code_of([&] { backend_->set_values(*a, matrix, {}); }),
                  ErrorCode::invalid_argument)
            << "fault " << i;
    }
}

TEST_P(BackendContract, InvertsTheDiagonalOfSquareMatricesAlone) {
    const BlockMatrix wide = random_matrix(11, 12, 3, 3, 299);
    const BlockMatrix of_wide_blocks = random_matrix(11, 11, 3, 6, 299);

    expect_refused({
        [&] { backend_->make_operator(wide, random_diagonal(wide, 300)); },
        [&] { backend_->make_operator(of_wide_blocks, random_diagonal(of_wide_blocks, 300)); },
    });
}

TEST_P(BackendContract, RefusesSizesThatDoNotMatch) {
    prepare(odd_model());
    const DeviceOperator& stiffness = backend_->stiffness();
    for (Index columns : column_counts) {
        const auto state = to_device(*backend_, random_state(columns, 310));
        const auto small = to_device(*backend_, random_columns(30, columns, 311));
        const auto also_small = backend_->make_vector(30, columns);
        const auto large = backend_->make_vector(33, columns);
        const auto sums = backend_->make_sums(columns), other = backend_->make_sums(columns);
        const auto wide = backend_->make_sums(columns + 1);
        backend_->set(*sums, std::vector<double>(columns, 1.0));
        std::vector<double> many(columns + 1), moduli(2);
        const auto advance = [&](const DeviceSums& rz, const DeviceVector& p, DeviceSums& rr_new) {
            const auto x = backend_->make_vector(30, columns);
            backend_->advance(rz, *sums, *sums, *sums, p, *small, *x, *x, rr_new);
        };
        const Calls calls = {
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
            [&] { advance(*sums, *small, *wide); },
            [&] { backend_->turn(*sums, *sums, *small, *large); },
            [&] { backend_->turn(*wide, *sums, *small, *small); },
            [&] { backend_->turn(*sums, *wide, *small, *small); },
            [&] { backend_->apply(stiffness, *small, *large); },
            [&] { backend_->apply(stiffness, *state, *state); },
            [&] { backend_->apply_inverse_diagonal(stiffness, 1, *small, *large); },
            [&] { backend_->internal_force(*small, *large); },
            [&] { backend_->internal_force(*state, *state); },
            [&] { backend_->internal_force(*small, *also_small); },
            [&] { backend_->strain_energy(*small, std::span(many).first(columns)); },
            [&] { backend_->strain_energy(*state, many); },
            [&] { backend_->parameter_gradient(*small, *large, moduli); },
            [&] { backend_->parameter_gradient(*small, *also_small, moduli); },
            [&] { backend_->parameter_gradient(*state, *state, std::span(moduli).first(1)); },
            [&] { backend_->set_stiffness(std::vector{1.0}); },
            [&] {
                backend_->set_stiffness(std::vector{1.0, 0.0});
            },
            [&] {
                backend_->set_stiffness(std::vector{-1.0, 1.0});
            },
            [&] {
                backend_->set_stiffness(std::vector{1.0, nan});
            },
        };

        expect_refused(calls);
    }
}

TEST_P(BackendContract, AdvancesWithVectorsOfOneShapeAndSumsOfTheirColumns) {
    const auto v = to_device(*backend_, random_columns(30, 2, 312));
    const auto w = backend_->make_vector(30, 2), x = backend_->make_vector(30, 2),
               r = backend_->make_vector(30, 2);
    const auto sums = sums_of(*backend_, {1, 1}), rr_new = backend_->make_sums(2);
    const auto wide = sums_of(*backend_, {1, 1, 1});
    const auto longer = backend_->make_vector(31, 2), wider = backend_->make_vector(30, 3);
    const auto with_sums = [&](const DeviceSums& rz, const DeviceSums& pq, const DeviceSums& rr,
                               const DeviceSums& limit) {
        return [&, this] { backend_->advance(rz, pq, rr, limit, *v, *w, *x, *r, *rr_new); };
    };
    const auto with_vectors = [&](const DeviceVector& p, const DeviceVector& q, DeviceVector& to_x,
                                  DeviceVector& to_r) {
        return
            [&, this] { backend_->advance(*sums, *sums, *sums, *sums, p, q, to_x, to_r, *rr_new); };
    };

    expect_refused({
        with_sums(*wide, *sums, *sums, *sums),
        with_sums(*sums, *wide, *sums, *sums),
        with_sums(*sums, *sums, *wide, *sums),
        with_sums(*sums, *sums, *sums, *wide),
        with_sums(*rr_new, *sums, *sums, *sums),
        with_sums(*sums, *rr_new, *sums, *sums),
        with_sums(*sums, *sums, *rr_new, *sums),
        with_sums(*sums, *sums, *sums, *rr_new),
        with_vectors(*longer, *w, *x, *r),
        with_vectors(*v, *longer, *x, *r),
        with_vectors(*v, *w, *wider, *r),
        with_vectors(*v, *w, *x, *wider),
    });
}

class ForeignVector final : public DeviceVector {
    using DeviceVector::DeviceVector;
};
class ForeignSums final : public DeviceSums {
    using DeviceSums::DeviceSums;
};
class ForeignOperator final : public DeviceOperator {
    using DeviceOperator::DeviceOperator;
};

TEST_P(BackendContract, RefusesWhatAnotherBackEndMade) {
    prepare(fixtures::two_tissue_model({1, 1, 1}));
    const Index rows = model_.num_dofs();
    const BlockMatrix matrix = random_matrix(rows / 3, rows / 3, 3, 3, 313);
    const std::vector<double> diagonal = random_diagonal(matrix, 314);
    const auto a = backend_->make_operator(matrix, diagonal);
    const auto x = to_device(*backend_, random_state(2, 315));
    const auto y = backend_->make_vector(rows, 2), z = backend_->make_vector(rows, 2);
    const auto sums = sums_of(*backend_, {1, 1}), rr_new = backend_->make_sums(2);
    ForeignVector vector(rows, 2);
    ForeignSums foreign_sums(2);
    ForeignOperator foreign_a(matrix, true);
    const std::vector<Index> column = {0};
    std::vector<double> host(x->size()), pair(2);
    const auto advance = [&](const DeviceSums& rz, const DeviceSums& limit, const DeviceVector& p,
                             DeviceVector& r, DeviceSums& to) {
        backend_->advance(rz, *sums, *sums, limit, p, *x, *y, r, to);
    };

    expect_refused({
        [&] { backend_->fill(vector, 1); },
        [&] { backend_->copy_in(host, vector); },
        [&] { backend_->copy_out(vector, host); },
        [&] { backend_->copy_columns(vector, column, *y, column); },
        [&] { backend_->copy_columns(*x, column, vector, column); },
        [&] { backend_->set(foreign_sums, pair); },
        [&] { backend_->read(foreign_sums, pair); },
        [&] { backend_->dot(vector, *x, *sums); },
        [&] { backend_->dot(*x, vector, *sums); },
        [&] { backend_->dot(*x, *x, foreign_sums); },
        [&] { backend_->set_values(foreign_a, matrix, diagonal); },
        [&] { backend_->apply(foreign_a, *x, *y); },
        [&] { backend_->apply(*a, vector, *y); },
        [&] { backend_->apply(*a, *x, vector); },
        [&] { backend_->apply(*a, *x, *y, &foreign_sums); },
        [&] { backend_->residual(*a, vector, *x, *y); },
        [&] { backend_->apply_inverse_diagonal(foreign_a, 1, *x, *y); },
        [&] { backend_->apply_inverse_diagonal(*a, 1, vector, *y); },
        [&] { backend_->apply_inverse_diagonal(*a, 1, *x, vector); },
        [&] { backend_->apply_inverse_diagonal(*a, 1, *x, *y, &foreign_sums); },
        [&] { advance(foreign_sums, *sums, *x, *z, *rr_new); },
        [&] { advance(*sums, foreign_sums, *x, *z, *rr_new); },
        [&] { advance(*sums, *sums, vector, *z, *rr_new); },
        [&] { advance(*sums, *sums, *x, vector, *rr_new); },
        [&] { advance(*sums, *sums, *x, *z, foreign_sums); },
        [&] { backend_->turn(foreign_sums, *sums, *x, *y); },
        [&] { backend_->turn(*sums, foreign_sums, *x, *y); },
        [&] { backend_->turn(*sums, *sums, vector, *y); },
        [&] { backend_->turn(*sums, *sums, *x, vector); },
        [&] { backend_->internal_force(vector, *y); },
        [&] { backend_->internal_force(*x, vector); },
        [&] { backend_->strain_energy(vector, pair); },
        [&] { backend_->parameter_gradient(vector, *x, pair); },
        [&] { backend_->parameter_gradient(*x, vector, pair); },
    });
}

TEST_P(BackendContract, NamesTheFunctionAndTheSizes) {
    const auto x = backend_->make_vector(30, 2), y = backend_->make_vector(31, 2);
    const auto sums = backend_->make_sums(2);
    try {
        backend_->dot(*x, *y, *sums);
        FAIL() << "no exception";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(),
                     "Backend::dot: vectors of one shape are needed, not of 30x2 and 31x2.");
    }
}

TEST_P(BackendContract, WantsAModelForWhatIsOfAModel) {
    const auto nothing = backend_->make_vector(0, 1), also_nothing = backend_->make_vector(0, 1);
    std::vector<double> one(1);

    expect_refused({
        [&] { backend_->stiffness(); },
        [&] { backend_->set_stiffness({}); },
        [&] { backend_->internal_force(*nothing, *also_nothing); },
        [&] { backend_->strain_energy(*nothing, one); },
        [&] { backend_->parameter_gradient(*nothing, *also_nothing, {}); },
    });
}

TEST_P(BackendContract, KeepsTheStiffnessOfItsModelToItself) {
    prepare(fixtures::two_tissue_model({1, 1, 1}));
    const BlockMatrix matrix = random_matrix(8, 8, 3, 3, 316);
    auto& stiffness = const_cast<DeviceOperator&>(backend_->stiffness());

    EXPECT_EQ(
        code_of([&] { backend_->set_values(stiffness, matrix, random_diagonal(matrix, 317)); }),
        ErrorCode::invalid_argument);
}

TEST_P(BackendContract, RefusesAModelThatIsNotValid) {
    Model model = odd_model();
    std::swap(model.mesh.tets[5][0], model.mesh.tets[5][1]);

    EXPECT_EQ(code_of([&] { backend_->prepare(model); }), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace palpate::backend_contract
