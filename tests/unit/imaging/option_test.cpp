// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/io/option_values.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

const std::vector<Option> table = {
    Option::input_file("reference", "A file").required().positional(),
    Option::integer("nodes", 500, 500000, "How many").usually(6000),
    Option::number("noise", "mm", {0, 20, true}, "How far off").usually(1),
    Option::choice("align", {"auto", "none"}, "How to align").usually("auto"),
    Option::number("moves", "mm", any_number, "How far it moved").list(2, 3),
    Option::text("organs", "Some names").list(1, Option::any_count).excludes({"align"}),
    Option::flag("plan", "Only a plan"),
    Option::number("motion", "mm", {0, 50}, "How far").needs({"plan"}),
};

std::string refusal_of_settings(const std::string& toml) {
    try {
        OptionValues::from_settings(table, toml, "settings");
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
        return error.what();
    }
    return "";
}

std::string refusal_of_words(const OptionWords& words) {
    try {
        OptionValues::from_words(table, words);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
        return error.what();
    }
    return "";
}

TEST(Option, SettingsGiveTheSameValuesAsWords) {
    const auto told = OptionValues::from_settings(
        table, "reference = 'a.nii'\nnodes = 700\nnoise = 2\nmoves = [1, 2.5]\nplan = true", "t");
    const auto typed = OptionValues::from_words(table, {{"reference", {"a.nii"}},
                                                        {"nodes", {"700"}},
                                                        {"noise", {"2"}},
                                                        {"moves", {"1", "2.5"}},
                                                        {"plan", {}}});

    for (const OptionValues* values : {&told, &typed}) {
        EXPECT_EQ(values->text("reference"), "a.nii");
        EXPECT_EQ(values->integer("nodes"), 700);
        EXPECT_EQ(values->number("noise"), 2.0);
        EXPECT_EQ(values->numbers("moves"), (std::vector{1.0, 2.5}));
        EXPECT_TRUE(values->flag("plan"));
        EXPECT_TRUE(values->is_given("nodes"));
    }
}

TEST(Option, WhatIsNotGivenIsWhatItUsuallyIs) {
    const auto values = OptionValues::from_settings(table, "reference = 'a.nii'", "t");

    EXPECT_EQ(values.integer("nodes"), 6000);
    EXPECT_EQ(values.number("noise"), 1.0);
    EXPECT_EQ(values.text("align"), "auto");
    EXPECT_FALSE(values.flag("plan"));
    EXPECT_FALSE(values.is_given("nodes"));
    EXPECT_FALSE(values.optional_number("motion"));
    EXPECT_TRUE(values.texts("organs").empty());
}

TEST(Option, OneValueIsAListOfOne) {
    const auto values =
        OptionValues::from_settings(table, "reference = 'a.nii'\norgans = 'liver'", "t");

    EXPECT_EQ(values.texts("organs"), std::vector<std::string>{"liver"});
}

TEST(Option, RefusedSettingsSayWhereAndWhatIsAllowed) {
    EXPECT_EQ(refusal_of_settings("reference = 'a'\nnodes = 12"),
              "settings, line 2: key 'nodes' is 12; allowed: a whole number of at least 500 and at "
              "most 500000");
    EXPECT_EQ(refusal_of_settings("reference = 'a'\nnoise = 0"),
              "settings, line 2: key 'noise' is 0; allowed: a number greater than 0 and at most 20 "
              "(mm)");
    EXPECT_EQ(refusal_of_settings("reference = 'a'\nalign = 'both'"),
              "settings, line 2: key 'align' is 'both'; allowed: one of auto, none");
    EXPECT_EQ(refusal_of_settings("reference = 'a'\nmoves = [1]"),
              "settings, line 2: key 'moves' is a list; allowed: 2 to 3 numbers (mm)");
    EXPECT_NE(refusal_of_settings("reference = 'a'\nnode = 700").find("did you mean 'nodes'?"),
              std::string::npos);
    EXPECT_NE(refusal_of_settings("reference = 'a'\nnodes = 700.5").find("a whole number"),
              std::string::npos);
    EXPECT_NE(refusal_of_settings("reference = 'a'\nplan = 1").find("true or false"),
              std::string::npos);
    EXPECT_NE(refusal_of_settings("reference = 'a'\nnoise = nan").find("allowed"),
              std::string::npos);
}

TEST(Option, RefusedWordsSayWhichAndWhatIsAllowed) {
    EXPECT_EQ(refusal_of_words({{"reference", {"a"}}, {"nodes", {"12"}}}),
              "--nodes is 12; allowed: a whole number of at least 500 and at most 500000");
    EXPECT_EQ(refusal_of_words({{"reference", {"a"}}, {"align", {"both"}}}),
              "--align: both not in {auto,none}");
    EXPECT_NE(refusal_of_words({{"reference", {"a"}}, {"noise", {"2mm"}}}), "");
    EXPECT_NE(refusal_of_words({{"reference", {"a"}}, {"noise", {"inf"}}}), "");
    EXPECT_NE(refusal_of_words({{"reference", {"a"}}, {"nodes", {"7e2"}}}), "");
}

TEST(Option, WhatDoesNotGoTogetherIsRefused) {
    EXPECT_EQ(refusal_of_words({}), "reference is required: A file; allowed: path of a file");
    EXPECT_EQ(refusal_of_settings("reference = 'a'\norgans = 'b'\nalign = 'none'"),
              "organs excludes align; leave one of them out");
    EXPECT_EQ(refusal_of_words({{"reference", {"a"}}, {"motion", {"3"}}}),
              "--motion requires --plan; give it, or leave --motion out");
    EXPECT_EQ(refusal_of_settings("reference = 'a'\nplan = false\nmotion = 3"),
              "motion requires plan; give it, or leave motion out");
}

TEST(Option, AnEntryThatContradictsItselfIsADefect) {
    const Option nodes = Option::integer("nodes", 500, 1000, "How many");

    EXPECT_THROW(nodes.usually(12), Error);
    EXPECT_THROW(OptionValues::from_settings(table, "reference = 'a'", "t").flag("nodes"), Error);
    EXPECT_THROW(OptionValues::from_settings(table, "reference = 'a'", "t").flag("none"), Error);
}

TEST(Option, SettingTextIsReadBackAsTheSameValue) {
    const std::string odd = "a \"b\" \\c\nd\te";
    const auto values = OptionValues::from_settings(
        table,
        "reference = " + setting_text(odd) + "\nmoves = " + setting_text(std::vector{0.1, -2e-9}),
        "t");

    EXPECT_EQ(values.text("reference"), odd);
    EXPECT_EQ(values.numbers("moves"), (std::vector{0.1, -2e-9}));
}

TEST(Option, TextsNameOptionsAsTheirReaderDoes) {
    const std::vector<Option> named = {
        Option::number("time_limit", "s", any_number, "How long"),
        Option::text("out", "Where"),
    };

    EXPECT_EQ(as_settings_spell(named, "--out-of, --out, or --time-limit: --outline"),
              "--out-of, out, or time_limit: --outline");
    EXPECT_EQ(as_commands_spell(named, "time_limit, my_time_limit, but out is a word"),
              "--time-limit, my_time_limit, but out is a word");
}

}  // namespace
}  // namespace palpate
