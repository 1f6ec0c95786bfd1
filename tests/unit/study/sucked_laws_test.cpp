// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/apps/study/drawn_tissue.hpp"
#include "host/apps/study/studies.hpp"
#include "host/apps/study/sucked_scene.hpp"

namespace palpate {
namespace {

constexpr unsigned num_seed = 400;

TEST(DrawnTissue, TakesBothLawsInTurnWithOneTermOrTwo) {
    int num_exponential = 0, num_two_terms = 0;
    for (unsigned seed = 1; seed <= num_seed; ++seed) {
        const DrawnTissue tissue = draw_tissue(seed);
        EXPECT_TRUE(tissue.law == exponential_law || tissue.law == polynomial_law);
        EXPECT_NE(tissue.law, draw_tissue(seed + 1).law);
        num_exponential += tissue.law == exponential_law;
        num_two_terms += tissue.terms.size() == 2;
    }
    EXPECT_EQ(num_exponential, int(num_seed) / 2);
    EXPECT_NEAR(num_two_terms, num_seed / 2.0, num_seed / 8.0);
}

TEST(DrawnTissue, NeedsASuctionThatAspirateTakesAndRelaxesWithinTheFilm) {
    for (unsigned seed = 1; seed <= num_seed; ++seed) {
        const DrawnTissue tissue = draw_tissue(seed);
        EXPECT_GT(tissue.peak_kpa, 0);
        EXPECT_LE(tissue.peak_kpa, most_suction_mbar * kpa_per_mbar) << seed;
        for (const auto& [amplitude, time_s] : tissue.terms) {
            EXPECT_GT(amplitude, 0);
            EXPECT_LE(time_s, SuckedScene::film_s) << seed;
        }
        EXPECT_EQ(draw_tissue(seed).mu_kpa, tissue.mu_kpa);
    }
}

/// For travels of 1 to 1.6 mm. The suction that this takes is Theret's.
TEST(DrawnTissue, HasTheStiffnessOfItsOwnLaw) {
    for (unsigned seed = 1; seed <= num_seed; ++seed) {
        const DrawnTissue tissue = draw_tissue(seed);
        const double stiffness_kpa = tissue.kappa_kpa / usual_kappa_over_young;
        const double travel_mm =
            theret_stiffness(tissue.peak_kpa, SuckedScene::hole_radius_mm, 1) / stiffness_kpa;
        EXPECT_GE(travel_mm, 1 - 1e-12) << seed;
        EXPECT_LE(travel_mm, 1.6 + 1e-12) << seed;
        EXPECT_NEAR(stiffness_kpa / (6 * tissue.mu_kpa),
                    stiffening(tissue.law, tissue.gamma, travel_mm), 1e-9 * stiffness_kpa)
            << seed;
    }
}

TEST(Stiffening, IsOfEachLawsOwnKind) {
    // x = 1.3 / 25 * 2.5^2
    EXPECT_NEAR(stiffening(exponential_law, 10, 2.5), std::exp(3.25), 1e-9);
    EXPECT_NEAR(stiffening(polynomial_law, 10, 2.5), 4.25, 1e-12);
    EXPECT_EQ(stiffening("neo-hookean-reduced", 10, 2.5), 1);
}

class LawsReport : public testing::Test {
protected:
    static Study study() {
        StudyOptions options;
        options.phantoms = 1;
        return make_aspiration_laws_study(options);
    }
    /// A row of tissue of the polynomial with one term: ln evidence 100 of the right model, 50 of
    /// others.
    static Row row() {
        Row row;
        row.set("true_law", std::string(polynomial_law));
        row.set("true_terms", 1, 0);
        row.set("gamma", 10, 1);
        for (const char* law : {"neo-hookean-reduced", exponential_law, polynomial_law})
            for (const char* terms : {", 0", ", 1", ", 2"})
                row.set(std::string(law) + terms, 50, 1);
        row.set(std::string(polynomial_law) + ", 1", 100, 1);
        row.set("best_law", std::string(polynomial_law));
        row.set("best_terms", 1, 0);
        return row;
    }
    static double fact(const Row& row, const std::string& name) {
        const StudyReport report = study().report({row});
        const auto at = std::find_if(report.facts.begin(), report.facts.end(),
                                     [&](const Fact& one) { return one.first == name; });
        return at == report.facts.end() ? -1 : at->second;
    }
};

TEST_F(LawsReport, CountsLawsThatWereBeaten) {
    EXPECT_EQ(fact(row(), "law_compared"), 1);
    EXPECT_EQ(fact(row(), "law_right"), 1);
    EXPECT_EQ(fact(row(), "both_right"), 1);
    EXPECT_EQ(fact(row(), "neo_hookean_rejected"), 1);
    EXPECT_EQ(fact(row(), "told_apart_and_right"), 1);
    EXPECT_EQ(fact(row(), "models"), 9);
    EXPECT_EQ(fact(row(), "models_unusable"), 0);
}

TEST_F(LawsReport, DoesNotCallALawBeatenWhoseSearchDidNotEndWell) {
    Row one = row();
    one.set(std::string(exponential_law) + ", 1", std::string());

    EXPECT_EQ(fact(one, "law_compared"), 0);
    EXPECT_EQ(fact(one, "law_right"), 0);
    EXPECT_EQ(fact(one, "told_apart"), 0);
    EXPECT_EQ(fact(one, "terms_compared"), 1);
    EXPECT_EQ(fact(one, "terms_right"), 1);
    EXPECT_EQ(fact(one, "models_unusable"), 1);
}

TEST_F(LawsReport, TakesTheSimplerOfTwoThatAreABareMentionApart) {
    Row one = row();
    one.set(std::string(polynomial_law) + ", 2", 100.9, 1);
    EXPECT_EQ(fact(one, "terms_right"), 1);
    one.set(std::string(polynomial_law) + ", 2", 101.2, 1);
    EXPECT_EQ(fact(one, "terms_right"), 0);
    EXPECT_EQ(fact(one, "law_right"), 1);
}

TEST_F(LawsReport, TellsNothingWhereBothLawsFailed) {
    Row one = row();
    for (const char* law : {exponential_law, polynomial_law})
        for (const char* terms : {", 0", ", 1", ", 2"})
            one.set(std::string(law) + terms, std::string());
    one.set("best_law", std::string("neo-hookean-reduced"));

    EXPECT_EQ(fact(one, "law_compared"), 0);
    EXPECT_EQ(fact(one, "terms_compared"), 0);
    EXPECT_EQ(fact(one, "told_apart"), 0);
    EXPECT_EQ(fact(one, "neo_hookean_compared"), 0);
    EXPECT_EQ(fact(one, "models_unusable"), 6);
}

}  // namespace
}  // namespace palpate
