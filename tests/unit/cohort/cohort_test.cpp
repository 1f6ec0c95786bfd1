// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "host/cohort/case_record.hpp"
#include "host/cohort/claim.hpp"
#include "host/cohort/content_key.hpp"
#include "host/cohort/patient_queue.hpp"
#include "host/cohort/plain_statistics.hpp"
#include "host/cohort/plan_rows.hpp"
#include "host/cohort/recover_choice.hpp"
#include "host/cohort/shards.hpp"
#include "host/cohort/shared_failure.hpp"
#include "host/io/delimited_text.hpp"
#include "host/system/child_process.hpp"
#include "host/system/resident_memory.hpp"
#include "solver/base/error.hpp"
#include "solver/base/locked_folder.hpp"

namespace palpate {
namespace {

TEST(DelimitedText, KeepsCellsAsTheyAre) {
    const auto table = parse_delimited(
        "\xEF\xBB\xBF"
        "id,a\r\n\r\n007,\"x, \"\"y\"\"\"\r\nNA,nan",
        {','});
    EXPECT_TRUE(table.faults.empty());
    EXPECT_EQ(table.columns, (std::vector<std::string>{"id", "a"}));
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(table.rows[0], (std::vector<std::string>{"007", "x, \"y\""}));
    EXPECT_EQ(table.rows[1], (std::vector<std::string>{"NA", "nan"}));
    EXPECT_EQ(table.lines, (std::vector<std::size_t>{3, 4}));
}

TEST(DelimitedText, ListsAllFaults) {
    const auto table = parse_delimited("a\tb\n1\n1\t2\t3\nx\t\x01\n\xff\ty\n\"open\t1\n", {'\t'});
    std::multiset<std::size_t> lines;
    for (const TableFault& fault : table.faults) lines.insert(fault.line);
    EXPECT_EQ(lines, (std::multiset<std::size_t>{2, 3, 4, 5, 6}));
    EXPECT_TRUE(table.rows.empty());
    EXPECT_FALSE(parse_delimited("", {'\t'}).faults.empty());
    EXPECT_FALSE(parse_delimited("a\ta\n", {'\t'}).faults.empty());
}

TEST(DelimitedText, ReadsWhatItWrites) {
    const std::vector<std::string> cells{"plain", "say \"x\"", "", "two\nlines"};
    const auto table = parse_delimited("1\t2\t3\t4\n" + delimited_line(cells, '\t'), {'\t'});
    ASSERT_EQ(table.faults.size(), 1u);  // a line end in a cell is read, and refused there
    EXPECT_EQ(table.faults[0].column, "4");
    const auto good = parse_delimited("1,2,3\n" + delimited_line({"a,b", "\"", ""}, ','), {','});
    ASSERT_EQ(good.rows.size(), 1u);
    EXPECT_EQ(good.rows[0], (std::vector<std::string>{"a,b", "\"", ""}));
}

TEST(PlanRows, RefuseOddIds) {
    for (const char* id : {"", "..", "a/b", "-rf", "a b", "é", "a_b"})
        EXPECT_FALSE(is_cohort_id(id)) << id;
    EXPECT_FALSE(is_cohort_id(std::string(33, 'a')));
    for (const char* id : {"007", "NA", "nan", "sub-07"}) EXPECT_TRUE(is_cohort_id(id)) << id;
}

TEST(PlanRows, TellEveryFaultWithLineAndColumn) {
    std::vector<PlanRequestRow> rows;
    const auto faults = for_each_plan_row(
        "participant_id\treference\ttarget\tcase_id\talign\n"
        "a\tr.nii\tr.nii\t\t\n"
        "b b\tr.nii\tt.nii\t\tsideways\n"
        "c\tr.nii\tt.nii\tone\t\n"
        "c\tr.nii\tu.nii\tone\t\n"
        "d\t\tt.nii\treference\t\n",
        {'\t'}, "/data", [&](const PlanRequestRow& row) { rows.push_back(row); });
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].reference, "/data/r.nii");
    std::set<std::pair<std::size_t, std::string>> found;
    for (const TableFault& fault : faults) found.emplace(fault.line, fault.column);
    const std::set<std::pair<std::size_t, std::string>> wanted{
        {2, "target"},  {3, "participant_id"}, {3, "align"},
        {5, "case_id"}, {6, "reference"},      {6, "case_id"}};
    EXPECT_EQ(found, wanted);
}

TEST(PlanRows, RefuseUnknownAndMissingColumns) {
    const auto faults = for_each_plan_row("participant_id\treference\tage\n1\t2\t3\n", {'\t'},
                                          "/data", [](PlanRequestRow&) { ADD_FAILURE(); });
    EXPECT_EQ(faults.size(), 2u);
}

TEST(ContentKey, IsSha256) {  // FIPS 180-4, examples
    EXPECT_EQ(sha256_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_THROW(sha256_of_file("/no/such/file"), Error);
}

TEST(ContentKey, ChangesWithEveryPart) {
    const KeyParts parts{"toml", {{"nodes", "6000"}}, "r", "t", ""};
    std::set<std::string> keys{case_key(parts)};
    for (int k = 0; k < 6; ++k) {
        KeyParts other = parts;
        if (k == 0) other.settings_toml = "other";
        if (k == 1) other.options["nodes"] = "7000";
        if (k == 2) other.reference_sha256 = "x";
        if (k == 3) other.target_sha256 = "x";
        if (k == 4) other.transform_sha256 = "x";
        if (k == 5) other.is_test_stub = true;
        EXPECT_TRUE(keys.insert(case_key(other)).second) << k;
    }
    EXPECT_EQ(case_key(parts), case_key(KeyParts(parts)));
}

TEST(ContentKey, LargeDeformationHasANumberOfItsOwn) {
    const char* name = "large_deformation_version";
    EXPECT_EQ(options_of_the_key(recover_values("")).count(name), 0u);
    const auto large = options_of_the_key(recover_values("material = \"neo-hookean\"\n"));
    ASSERT_EQ(large.count(name), 1u);
    EXPECT_EQ(large.at(name), std::to_string(large_deformation_version));
}

TEST(Shards, HoldEveryPatientOnceAndAreBalanced) {
    const std::vector<double> estimates{9, 1, 1, 1, 8, 7, 6, 5, 4, 3};
    const auto shards = balanced_shards(estimates, 3);
    std::set<std::size_t> seen;
    for (const auto& shard : shards) {
        double sum = 0;
        for (const std::size_t k : shard) {
            sum += estimates[k];
            EXPECT_TRUE(seen.insert(k).second);
        }
        EXPECT_NEAR(sum, 15, 1);
    }
    EXPECT_EQ(seen.size(), estimates.size());
    EXPECT_EQ(balanced_shards({1}, 4).size(), 4u);
}

Shard in_environment(const std::map<std::string, std::string>& variables) {
    return shard_of("auto", [&](const char* name) {
        const auto found = variables.find(name);
        return found == variables.end() ? nullptr : found->second.c_str();
    });
}

TEST(Shards, AreReadFromTextAndArrayJobs) {
    const auto nothing = [](const char*) -> const char* { return nullptr; };
    EXPECT_EQ(shard_of("3/50", nothing).number, 3u);
    EXPECT_EQ(shard_of("3/50", nothing).count, 50u);
    for (const char* bad : {"0/3", "4/3", "1", "a/b", "1/", "auto"})
        EXPECT_THROW(shard_of(bad, nothing), Error) << bad;
    const Shard slurm = in_environment({{"SLURM_ARRAY_TASK_ID", "7"},
                                        {"SLURM_ARRAY_TASK_MIN", "5"},
                                        {"SLURM_ARRAY_TASK_MAX", "8"}});
    EXPECT_EQ(slurm.number, 3u);
    EXPECT_EQ(slurm.count, 4u);
    EXPECT_EQ(
        in_environment({{"AWS_BATCH_JOB_ARRAY_INDEX", "0"}, {"AWS_BATCH_JOB_ARRAY_SIZE", "2"}})
            .number,
        1u);
    EXPECT_THROW(in_environment({{"SGE_TASK_ID", "undefined"}}), Error);
    EXPECT_THROW(in_environment({{"LSB_JOBINDEX", "0"}}), Error);
    EXPECT_EQ(in_environment({{"PBS_ARRAY_INDEX", "2"}, {"PALPATE_SHARDS", "3"}}).count, 3u);
}

TEST(Claim, IsHeldByOneAndLeavesNoFile) {
    const LockedFolder folder(std::filesystem::temp_directory_path(), "palpate-claim-",
                              LockedFolder::Readers::owner);
    const auto file = folder.path() / ".sub.claim";
    {
        const auto first = Claim::take(file);
        ASSERT_TRUE(first);
        EXPECT_FALSE(Claim::take(file));
        EXPECT_TRUE(Claim::is_held(file));
    }
    EXPECT_FALSE(Claim::is_held(file));
    EXPECT_FALSE(std::filesystem::exists(file));
    std::ofstream(file) << "";  // of a runner that was killed
    EXPECT_TRUE(Claim::take(file));
}

TEST(PatientQueue, GoesOnWithTheOthersAndThenTriesAlone) {
    PatientQueue queue({"a", "b", "c"}, 3);
    EXPECT_EQ(queue.next().cases.size(), 3u);
    queue.done("a");
    EXPECT_TRUE(queue.failed("b", 1, "crash").empty());
    EXPECT_EQ(queue.next().cases, std::vector<std::string>{"c"});
    queue.done("c");
    EXPECT_EQ(queue.next().cases, std::vector<std::string>{"b"});
    EXPECT_FALSE(queue.next().on_reference_backend);
    EXPECT_TRUE(queue.failed("b", 1, "crash").empty());
    EXPECT_TRUE(queue.next().on_reference_backend);
    const auto over = queue.failed("b", 1, "crash");
    ASSERT_EQ(over.size(), 1u);
    EXPECT_EQ(over[0].attempts, 3);
    EXPECT_TRUE(queue.is_empty());
}

TEST(SharedFailure, IsOfSeveralPatientsAndOneCodeWhereNothingWorked) {
    struct Run {
        int failures = SharedFailure::enough, patients = SharedFailure::enough_patients, code = 4;
        bool has_result = false, has_other_code = false;
    };
    const auto sentence_of = [](const Run& run) {
        SharedFailure shared;
        if (run.has_result) shared.add_result();
        if (run.has_other_code) shared.add_failure("p", run.code + 1, "other");
        for (int k = 0; k < run.failures; ++k)
            shared.add_failure(std::string(1, char('a' + k % run.patients)), run.code,
                               k == 0 ? "first" : "later");
        return shared.sentence();
    };
    EXPECT_EQ(sentence_of({}), "first");
    EXPECT_EQ(sentence_of({.failures = SharedFailure::enough - 1}), std::nullopt);
    EXPECT_EQ(sentence_of({.patients = SharedFailure::enough_patients - 1}), std::nullopt);
    EXPECT_EQ(sentence_of({.code = exit_code_of(ErrorCode::time_limit)}), std::nullopt);
    EXPECT_EQ(sentence_of({.has_result = true}), std::nullopt);
    EXPECT_EQ(sentence_of({.has_other_code = true}), std::nullopt);
}

// Of a library that other processes map too each counts a part only: while other tests begin and
// end, what is told of this process goes up and down by half of its libraries, some 20 MB.
constexpr double held_mb = 200, clearly_mb = held_mb / 2;

TEST(ResidentMemory, IsOfAProcessAndOfWhatItHasStarted) {
    EXPECT_EQ(resident_mb(0x7ffffff0), 0);
    const double before = resident_mb(::getpid());
    // A shell's shell has the memory.
    ChildProcess shell("/bin/sh",
                       {"-c",
                        "/bin/sh -c 'x=$(head -c 200000000 /dev/zero | tr \"\\0\" x); echo held; "
                        "sleep 600; echo $x'; true"},
                       {});
    for (std::string said; said.find("held") == said.npos; ::usleep(10000)) {
        ASSERT_FALSE(shell.ended());
        shell.output().drain(said);
    }
    const double seen_mb = resident_mb(::getpid());
    EXPECT_GT(seen_mb, before + clearly_mb);
    EXPECT_TRUE(holds_more_than(::getpid(), before + clearly_mb));
    EXPECT_FALSE(holds_more_than(::getpid(), seen_mb + 1000));
}

TEST(ResidentMemory, CountsPagesThatTwoProcessesShareOnce) {
    const std::vector<char> held(std::size_t(held_mb * 1e6), 'x');
    const double alone = resident_mb(::getpid());
    const pid_t copy = ::fork();
    if (copy == 0) {
        ::pause();
        ::_exit(int(held.size()));
    }
    ASSERT_GT(copy, 0);
    const double both = resident_mb(::getpid());
    const bool shared_too = holds_more_than(::getpid(), alone + clearly_mb);
    ::kill(copy, SIGKILL);
    ::waitpid(copy, nullptr, 0);
    EXPECT_GT(alone, held_mb);
    EXPECT_LT(both, alone + clearly_mb);
    // Of pages counted for each process there are more.
    EXPECT_FALSE(shared_too);
}

TEST(PatientQueue, GivesWhatTookTooLongTwiceTheTimeOnce) {
    PatientQueue queue({"a", "b"}, 5);
    const int late = exit_code_of(ErrorCode::time_limit);
    EXPECT_TRUE(queue.failed("a", late, "late").empty());
    EXPECT_EQ(queue.next().limit_factor, 1);  // of the others
    queue.done("b");
    EXPECT_EQ(queue.next().limit_factor, 2);
    EXPECT_EQ(queue.failed("a", late, "late").size(), 1u);
    PatientQueue of_reference({"a"}, 5);
    EXPECT_TRUE(of_reference.failed("", late, "late").empty());
    EXPECT_EQ(of_reference.next().limit_factor, 2);
    EXPECT_EQ(of_reference.failed("", late, "late").size(), 1u);
}

TEST(PatientQueue, EndsWhatCannotGetBetterAtOnce) {
    PatientQueue queue({"a", "b"}, 3);
    EXPECT_EQ(queue.failed("a", 4, "no overlap").size(), 1u);
    EXPECT_EQ(queue.failed("", 3, "the reference is damaged").size(), 1u);
    EXPECT_TRUE(queue.is_empty());
}

TEST(CaseRecord, ComesBackFromItsLine) {
    CaseRecord record{"p", "target-01", "key", "0.1"};
    record.seconds = 1.5;
    RegionRecord region{"prostate", "weak", 50, 0.2, 34, 74};
    take_prior_out(region, 100, 1.2);
    record.regions = {region, {"other", "not identifiable"}};
    const auto again = record_of(record_line(record));
    ASSERT_TRUE(again);
    EXPECT_EQ(record_line(*again), record_line(record));
    EXPECT_TRUE(std::isnan(again->regions[1].e_kpa));
    EXPECT_FALSE(record_of("{\"format\": \"palpate-cohort-case\"}"));
    EXPECT_FALSE(record_of("{\"torn"));
}

TEST(CaseRecord, PriorAndDataMultiplyToThePosterior) {
    RegionRecord region{"r", "weak", 50, 0.3};
    take_prior_out(region, 100, 1.2);
    const double data = 1 / (region.sd_data * region.sd_data), prior = 1 / (1.2 * 1.2);
    EXPECT_NEAR(1 / std::sqrt(data + prior), 0.3, 1e-12);
    EXPECT_NEAR((region.ln_e_data * data + std::log(100.0) * prior) / (data + prior),
                std::log(50.0), 1e-12);
    RegionRecord nothing{"r", "weak", 50, 1.2};
    take_prior_out(nothing, 100, 1.2);
    EXPECT_TRUE(std::isnan(nothing.sd_data));
}

TEST(PlainStatistics, AreMeanSdAndMedian) {
    const PlainStatistics four = plain_statistics({4, 1, 3, 2});
    EXPECT_DOUBLE_EQ(four.mean, 2.5);
    EXPECT_DOUBLE_EQ(four.sd, std::sqrt(5.0 / 3));
    EXPECT_DOUBLE_EQ(four.median, 2.5);
    EXPECT_TRUE(std::isnan(plain_statistics({1}).sd));
    EXPECT_TRUE(std::isnan(plain_statistics({}).mean));
}

}  // namespace
}  // namespace palpate
