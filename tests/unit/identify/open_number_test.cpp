// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/apps/identify/open_parameter.hpp"
#include "host/io/closed_document.hpp"
#include "host/io/settings_table.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

constexpr NumberRange above_zero{0, any_number.high, true};

/// The open number that stands at `mu_kpa` of the second [[material]].
OpenNumber read(const std::string& value) {
    std::vector<OpenNumber> seen;
    const auto document =
        SettingsTable::parse("[[material]]\nmu_kpa = 1\n[[material]]\nmu_kpa = " + value, "m.toml",
                             [&](const OpenNumber& number) {
                                 seen.push_back(number);
                                 return 7.0;
                             });
    EXPECT_EQ(document.tables("material")[0].number("mu_kpa", above_zero), 1.0);
    EXPECT_EQ(document.tables("material")[1].number("mu_kpa", above_zero), 7.0);
    EXPECT_EQ(seen.size(), 1u);
    return seen.at(0);
}

TEST(OpenNumber, IsToldWithItsPlaceAndWhatIsKnownOfIt) {
    const OpenNumber plain = read("\"unknown\"");
    EXPECT_EQ(plain.path, "material[2].mu_kpa");
    EXPECT_TRUE(plain.is_unknown);
    EXPECT_FALSE(plain.start);

    const OpenNumber full =
        read("{unknown = true, start = 2, lowest = 0.1, highest = 50, median = 3, sd_ln = 1.5}");
    EXPECT_EQ(full.start, 2.0);
    EXPECT_EQ(full.lowest, 0.1);
    EXPECT_EQ(full.median, 3.0);
    EXPECT_EQ(full.sd_ln, 1.5);

    const OpenNumber nuisance = read("{value = 2, sd = 0.5}");
    EXPECT_FALSE(nuisance.is_unknown);
    EXPECT_EQ(nuisance.value, 2.0);
    EXPECT_EQ(nuisance.sd, 0.5);
}

TEST(OpenNumber, MistakesAreNamedWithTheirLine) {
    for (const char* wrong :
         {"{unknown = true, value = 2}", "{value = 2}", "{value = 2, sd = 0}", "{sd = 1}",
          "{value = -2, sd = 1}", "{unknown = true, start = -1}", "{unknown = false}",
          "{unknown = true, begin = 1}", "{unknown = true, lowest = 3, highest = 2}",
          "{value = 2, sd = 1, start = 2}", "{unknown = true, start = \"x\"}"})
        expect_refused([&] { read(wrong); }, {"m.toml, line 4", "mu_kpa"});
}

TEST(OpenNumber, IsRefusedWhereNobodyAnswersForIt) {
    const auto document = SettingsTable::parse("mu_kpa = \"unknown\"", "m.toml");
    expect_refused([&] { document.number("mu_kpa", above_zero); }, {"mu_kpa", "greater than 0"});
}

TEST(OpenNumber, StandsInListsToo) {
    std::string path;
    const auto document = SettingsTable::parse("size_mm = [1, {value = 2, sd = 0.1}]", "m.toml",
                                               [&](const OpenNumber& number) {
                                                   path = number.path;
                                                   return number.value;
                                               });
    EXPECT_EQ(document.numbers("size_mm", 2, 2), (std::vector<double>{1, 2}));
    EXPECT_EQ(path, "size_mm[2]");
}

TEST(OpenParameter, ItsScaleFollowsFromTheRangeAndItsPriorFromTheLaws) {
    const Parameter modulus = parameter_of(read("\"unknown\""));
    EXPECT_EQ(modulus.transform, Transform::log);
    EXPECT_EQ(modulus.unit, "kPa");
    EXPECT_EQ(modulus.object, "material[2]");
    EXPECT_GT(modulus.median, 0);
    EXPECT_EQ(modulus.start, modulus.median);
    EXPECT_TRUE(modulus.has_prior());

    const Parameter nuisance = parameter_of(read("{value = 2, sd = 0.5}"));
    EXPECT_EQ(nuisance.transform, Transform::identity);
    EXPECT_TRUE(nuisance.is_nuisance);
    EXPECT_EQ(nuisance.sd, 0.5);

    const OpenNumber ratio{
        .path = "material[1].poisson_ratio", .key = "poisson_ratio", .range = {-1, 0.5, true}};
    EXPECT_EQ(parameter_of(ratio).transform, Transform::logit);
    EXPECT_EQ(parameter_of(ratio).highest, 0.5);
}

TEST(OpenParameter, SomethingMustSayWhereToBegin) {
    OpenNumber number{.path = "pressure[1].kpa", .key = "kpa"};
    expect_refused([&] { parameter_of(number); }, {"pressure[1].kpa", "start"});
    number.start = -3;
    EXPECT_EQ(parameter_of(number).start, -3);
    EXPECT_FALSE(parameter_of(number).has_prior());
}

TEST(ClosedDocument, HasNumbersInPlaceAndNoData) {
    DocumentClosing closing;
    closing.numbers = {{"material[1].mu_kpa", 1.25}, {"mesh.size_mm[2]", 4}};
    closing.dropped = {"data"};
    closing.file_name = [](const std::string& file) { return "../" + file; };
    const std::string toml = closed_document(
        "[mesh]\nsize_mm = [1, \"unknown\"]\nfile = \"m.vtu\"\n[[material]]\nmu_kpa = \"unknown\"\n"
        "[[data]]\nfile = \"a.csv\"\n",
        "m.toml", closing);

    const auto read_back = SettingsTable::parse(toml, "m.toml");
    EXPECT_FALSE(read_back.has("data"));
    EXPECT_EQ(read_back.tables("material")[0].number("mu_kpa", above_zero), 1.25);
    EXPECT_EQ(read_back.table("mesh")->numbers("size_mm", 2, 2), (std::vector<double>{1, 4}));
    EXPECT_EQ(read_back.table("mesh")->text("file"), "../m.vtu");
}

}  // namespace
}  // namespace palpate
