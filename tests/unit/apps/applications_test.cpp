// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "host/apps/all.hpp"
#include "host/apps/describe.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::string text_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

bool is_name(const std::string& text) {
    return !text.empty() && std::islower(static_cast<unsigned char>(text.front())) &&
           text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

TEST(Applications, EveryTableIsWhole) {
    std::set<std::string> names;
    for (const Application& application : applications()) {
        EXPECT_TRUE(is_name(application.name)) << application.name;
        EXPECT_TRUE(names.insert(application.name).second) << application.name << " is there twice";
        EXPECT_FALSE(application.summary.ends_with('.')) << application.name;
        std::set<std::string> options;
        for (const Option& option : all_options(application)) {
            EXPECT_TRUE(is_name(option.name)) << option.name;
            EXPECT_TRUE(options.insert(option.name).second) << option.name << " is there twice";
            EXPECT_GT(option.meaning.size(), 5u) << option.name;
            EXPECT_FALSE(option.meaning.ends_with('.')) << option.name;
            EXPECT_FALSE(option.is_required && option.usual) << option.name;
        }
        for (const Option& option : application.options)
            for (const auto& others : {option.excluded, option.needed})
                for (const std::string& other : others)
                    EXPECT_TRUE(options.count(other)) << option.name << " names " << other;
    }
}

TEST(Applications, TheDocumentationSaysWhatTheTablesSay) {
    EXPECT_EQ(text_of("docs/applications.md"), applications_markdown(applications()))
        << "make it again: palpate describe > docs/applications.md";
}

TEST(Applications, TheirDescriptionForProgramsHoldsEveryOption) {
    const auto json = nlohmann::json::parse(applications_json(applications()));

    ASSERT_EQ(json["applications"].size(), applications().size());
    for (std::size_t a = 0; a < applications().size(); ++a) {
        const auto options = all_options(applications()[a]);
        const auto& told = json["applications"][a]["options"];
        ASSERT_EQ(told.size(), options.size());
        for (std::size_t k = 0; k < options.size(); ++k) {
            EXPECT_EQ(told[k]["name"], options[k].name);
            EXPECT_EQ(told[k]["default"].is_null(), !options[k].usual) << options[k].name;
        }
    }
}

/// Reports twice, with a pause between.
Outcome run_slowly(const OptionValues&, const ProgressSink& progress) {
    report_progress(progress, "working", 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    report_progress(progress, "working", 1);
    return {};
}

TEST(Applications, ATimeLimitEndsTheWorkAtItsNextReport) {
    const Application slow{"slow", "Takes its time", {}, run_slowly};
    const auto run = [&](const char* settings) {
        run_application(slow, OptionValues::from_settings(all_options(slow), settings, "test"),
                        LimitEnds::work);
    };

    EXPECT_NO_THROW(run("time_limit = 60"));
    EXPECT_NO_THROW(run("time_limit = 0"));
    try {
        run("time_limit = 0.01");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::time_limit);
    }
}

TEST(Applications, AnUnknownOneIsRefusedWithTheNamesThereAre) {
    try {
        application_named("spring");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("springs"), std::string::npos);
    }
}

}  // namespace
}  // namespace palpate
