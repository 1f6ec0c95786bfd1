// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/estimate/verdict.hpp"

#include <gtest/gtest.h>

#include <string>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

TEST(Verdict, HasTheWordsThatFilesHoldAndIsReadFromThem) {
    EXPECT_STREQ(name_of(Verdict::recovered), "recovered");
    EXPECT_STREQ(name_of(Verdict::not_identifiable), "not identifiable");
    for (const Verdict verdict : {Verdict::recovered, Verdict::weak, Verdict::not_identifiable,
                                  Verdict::not_judged, Verdict::given, Verdict::hollow})
        EXPECT_EQ(verdict_of(name_of(verdict)), verdict);
}

TEST(Verdict, OtherWordsAreRefusedWithThoseThatAreAllowed) {
    try {
        verdict_of("not_identifiable");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        const std::string text = error.what();
        EXPECT_NE(text.find("\"not_identifiable\" is no verdict"), std::string::npos) << text;
        EXPECT_NE(text.find("\"not identifiable\", \"not judged\""), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace palpate
