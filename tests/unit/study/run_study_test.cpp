// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/run_study.hpp"

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "host/apps/study/study_folder.hpp"
#include "solver/base/error.hpp"
#include "tests/unit/report/temporary_folder.hpp"

namespace palpate {
namespace {

class RunStudy : public TemporaryFolderTest {
protected:
    void SetUp() override {
        TemporaryFolderTest::SetUp();
        options.folder = folder / "out";
    }

    /// Cases a, b, c whose rows hold how many cases were run before them.
    Study counting_study() {
        Study study{"counting", "Counting", {{"first seed", "1"}}, {"count"}, {}, {}};
        for (const char* id : {"a", "b", "c"})
            study.cases.push_back({id, id, [this, id](const ProgressSink& progress) {
                                       report_progress(progress, "working", 0);
                                       if (id == failing)
                                           throw Error(ErrorCode::mesh_failed, "no mesh");
                                       Row row;
                                       row.set("count", num_run++, 0);
                                       return row;
                                   }});
        study.report = [](const std::vector<Row>& rows) {
            StudyReport report;
            report.headline = "Counted <" + std::to_string(rows.size()) + ">";
            report.facts = {{"rows", double(rows.size())}};
            report.sections = {{"Pictures", "", {{"one", "<svg class='plot'></svg>", "", "One"}}}};
            return report;
        };
        return study;
    }

    std::string error_of(const Study& study) {
        try {
            run_study(study, options);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::output_failed);
            return error.what();
        }
        return "no error";
    }

    StudyRunOptions options;
    std::atomic<int> num_run = 0;
    std::string failing;
};

TEST_F(RunStudy, WritesOneRowForEachCase) {
    const StudyRun run = run_study(counting_study(), options);

    EXPECT_EQ(run.rows.size(), 3u);
    EXPECT_EQ(content_of(options.folder / "study.csv"), "case,count\na,0\nb,1\nc,2\n");
    EXPECT_EQ(names_in(options.folder), "study.csv study.json");
}

TEST_F(RunStudy, WhatTheSinkThrowsEndsTheStudyAndKeepsItsRows) {
    const StudyRun run = run_study(counting_study(), options, [this](const Progress&) {
        if (num_run == 2) throw Error(ErrorCode::time_limit, "too long");
    });

    EXPECT_EQ(run.rows.size(), 2u);
    EXPECT_TRUE(run.failures.empty());
    EXPECT_TRUE(run.is_cancelled);
    ASSERT_TRUE(run.stopped_by);
    EXPECT_THROW(std::rethrow_exception(run.stopped_by), Error);
}

TEST_F(RunStudy, ALimitOfOneCaseIsAFailureOfThatCase) {
    Study study = counting_study();
    study.cases[1].run = [](const ProgressSink&) -> Row {
        throw Error(ErrorCode::time_limit, "the mesher took too long");
    };

    const StudyRun run = run_study(study, options);

    EXPECT_EQ(run.rows.size(), 2u);
    ASSERT_EQ(run.failures.size(), 1u);
    EXPECT_EQ(run.failures[0].first, "b");
    EXPECT_FALSE(run.stopped_by);
}

TEST_F(RunStudy, AnEmptyReportOfACaseAsksWhetherToGoOn) {
    Study study = counting_study();
    study.cases[0].run = [](const ProgressSink& progress) -> Row {
        for (;;) check_cancelled(progress);
    };
    int empty = 0;

    const StudyRun run = run_study(study, options, [&](const Progress& step) {
        if (step.stage.empty() && ++empty == 3) throw Error(ErrorCode::cancelled, "enough");
    });

    EXPECT_TRUE(run.stopped_by && run.rows.empty() && run.failures.empty());
}

TEST_F(RunStudy, SkipsRowsThatAreThereAndTakesUpNewCases) {
    Study study = counting_study();
    study.cases.pop_back();
    run_study(study, options);

    const StudyRun run = run_study(counting_study(), options);

    EXPECT_EQ(run.num_resumed, 2u);
    EXPECT_EQ(num_run, 3);
    EXPECT_EQ(content_of(options.folder / "study.csv"), "case,count\na,0\nb,1\nc,2\n");
}

TEST_F(RunStudy, StopsInGoodOrderAndGoesOnLater) {
    options.is_cancelled = [this] { return num_run >= 2; };
    const StudyRun stopped = run_study(counting_study(), options);
    EXPECT_TRUE(stopped.is_cancelled);
    EXPECT_EQ(content_of(options.folder / "study.csv"), "case,count\na,0\nb,1\n");
    options.is_cancelled = {};

    const StudyRun run = run_study(counting_study(), options);

    EXPECT_FALSE(run.is_cancelled);
    EXPECT_EQ(run.num_resumed, 2u);
    EXPECT_EQ(run.rows.size(), 3u);
}

TEST_F(RunStudy, TellsACaseThatFailsAndTriesItAgain) {
    failing = "b";
    const StudyRun first = run_study(counting_study(), options);
    ASSERT_EQ(first.failures.size(), 1u);
    EXPECT_EQ(first.failures[0], (std::pair<std::string, std::string>("b", "no mesh")));
    EXPECT_EQ(first.rows.size(), 2u);
    failing.clear();

    const StudyRun second = run_study(counting_study(), options);

    EXPECT_TRUE(second.failures.empty());
    EXPECT_EQ(second.rows.size(), 3u);
}

TEST_F(RunStudy, RunsCasesAtTheSameTime) {
    options.jobs = 3;

    const StudyRun run = run_study(counting_study(), options);

    EXPECT_EQ(run.rows.size(), 3u);
    EXPECT_EQ(run.rows[2].text("case"), "c");
}

TEST_F(RunStudy, TheThreadThatCalledIsAskedWhileItWaitsForOthers) {
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> other_works = false, was_asked = false;
    Study study = counting_study();
    study.cases.pop_back();
    for (StudyCase& one : study.cases)
        one.run = [&](const ProgressSink&) {
            if (std::this_thread::get_id() == caller) {
                other_works.wait(false);
            } else {
                other_works = true;
                other_works.notify_one();
                was_asked.wait(false);
            }
            return Row();
        };
    options.jobs = 2;
    const auto sink = [&](const Progress& step) {
        if (std::this_thread::get_id() != caller || !step.stage.empty()) return;
        was_asked = true;
        was_asked.notify_one();
    };

    EXPECT_EQ(run_study(study, options, sink).rows.size(), 2u);
}

TEST_F(RunStudy, RefusesOtherSettingsAndOtherStudiesByName) {
    run_study(counting_study(), options);
    Study other = counting_study();
    other.settings[0].second = "7";
    const std::string settings = error_of(other);
    other.name = "another";
    const std::string name = error_of(other);

    EXPECT_NE(settings.find("holds this study with first seed 1, but 7 was asked for"),
              std::string::npos)
        << settings;
    EXPECT_NE(settings.find("--overwrite"), std::string::npos);
    EXPECT_NE(name.find("holds the study 'counting', not 'another'"), std::string::npos) << name;
}

TEST_F(RunStudy, BeginsAgainWhenAskedTo) {
    run_study(counting_study(), options);
    Study other = counting_study();
    other.settings[0].second = "7";
    options.overwrite = true;

    const StudyRun run = run_study(other, options);

    EXPECT_EQ(run.num_resumed, 0u);
    EXPECT_EQ(num_run, 6);
}

TEST_F(RunStudy, RefusesAFolderOfSomethingElse) {
    std::filesystem::create_directories(options.folder);
    std::ofstream(options.folder / "letter.txt") << "dear";
    options.overwrite = true;

    EXPECT_NE(error_of(counting_study()).find("holds files but no study"), std::string::npos);
    EXPECT_EQ(names_in(options.folder), "letter.txt");
}

TEST_F(RunStudy, SaysHowFarItIsAndHowLongItTakes) {
    std::vector<std::string> messages;
    run_study(counting_study(), options,
              [&](const Progress& progress) { messages.push_back(progress.message); });

    EXPECT_EQ(messages.front(), "0 of 3 done; a");
    EXPECT_NE(messages.back().find("2 of 3 done, "), std::string::npos) << messages.back();
    EXPECT_NE(messages.back().find(" left; c: working"), std::string::npos) << messages.back();
}

TEST_F(RunStudy, WritesPageSummaryAndPictures) {
    const Study study = counting_study();
    const StudyRun run = run_study(study, options);

    write_study_page(study, run, options.folder);

    EXPECT_EQ(names_in(options.folder), "pictures study.csv study.html study.json");
    EXPECT_NE(content_of(options.folder / "study.html").find("Counted &lt;3&gt;"),
              std::string::npos);
    const auto json = nlohmann::json::parse(content_of(options.folder / "study.json"));
    EXPECT_EQ(json["settings"]["first seed"], "1");
    EXPECT_EQ(json["summary"]["rows"], 3);
    const std::string picture = content_of(options.folder / "pictures" / "one.svg");
    EXPECT_EQ(picture.find("<svg xmlns='http://www.w3.org/2000/svg' class='plot'><style>"), 0u);
}

TEST_F(RunStudy, WritesAPageEvenWithoutRows) {
    Study study = counting_study();
    options.is_cancelled = [] { return true; };

    write_study_page(study, run_study(study, options), options.folder);

    EXPECT_NE(content_of(options.folder / "study.html").find("No case is done yet"),
              std::string::npos);
}

}  // namespace
}  // namespace palpate
