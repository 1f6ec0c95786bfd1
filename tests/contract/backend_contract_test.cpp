// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tests/contract/backend_contract.hpp"

// For whom the contract holds, and how they present themselves.
namespace palpate::backend_contract {
namespace {

std::string name_of(const testing::TestParamInfo<Case>& entry) {
    const Case& c = entry.param;
    std::string name = c.backend + (c.precision == Precision::single ? "_single_" : "_double_") +
                       name_of(c.product);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const std::string& backend : fixtures::backend_names())
        for (Precision precision : {Precision::single, Precision::double_})
            for (Product product : {Product::assembled, Product::matrix_free, Product::recomputed,
                                    Product::automatic})
                cases.push_back({backend, precision, product});
    return cases;
}

TEST_P(BackendContract, SaysWhoComputesAndHow) {
    const BackendInfo info = backend_->describe();

    EXPECT_EQ(info.backend, GetParam().backend);
    EXPECT_FALSE(info.device.empty());
    EXPECT_FALSE(info.version.empty());
    EXPECT_EQ(info.product, GetParam().product);
    if (GetParam().backend != "reference") {
        EXPECT_EQ(info.precision, GetParam().precision);
    }
    EXPECT_GE(info.compute_units, 1);
}

TEST_P(BackendContract, SaysWhichProductItChoseAndWhy) {
    if (GetParam().backend == "reference") GTEST_SKIP() << "The reference back end never measures.";
    prepare(odd_model());
    for (Index columns : column_counts) {
        const auto x = to_device(*backend_, random_state(columns, 1));
        const auto y = backend_->make_vector(model_.num_dofs(), columns);
        backend_->apply(backend_->stiffness(), *x, *y);
    }

    const std::vector<ProductChoice> choices = backend_->describe().choices;

    EXPECT_EQ(choices.empty(), GetParam().product != Product::automatic);
    for (const ProductChoice& choice : choices) {
        EXPECT_NE(choice.product, Product::automatic);
        EXPECT_GE(choice.columns, 1);
        EXPECT_NE(choice.reason.find(name_of(choice.product)), std::string::npos) << choice.reason;
    }
}

INSTANTIATE_TEST_SUITE_P(Registry, BackendContract, testing::ValuesIn(every_case()),
                         [](const auto& entry) { return name_of(entry); });

TEST(Registry, RefusesABackEndThatIsNotCompiledInAndNamesTheOthers) {
    try {
        make_backend("abacus", {});
        FAIL() << "no exception";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported);
        EXPECT_NE(std::string(error.what()).find("abacus"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("reference"), std::string::npos);
    }
}

TEST(Registry, AlwaysHoldsTheReferenceBackEnd) {
    const auto names = fixtures::backend_names();

    EXPECT_EQ(std::count(names.begin(), names.end(), "reference"), 1);
    for (const BackendEntry& entry : backend_registry())
        for (const DeviceInfo& device : entry.devices()) EXPECT_EQ(device.backend, entry.name);
}

}  // namespace
}  // namespace palpate::backend_contract
