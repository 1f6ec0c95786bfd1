// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/recovery_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/page/tree_json.hpp"
#include "tests/unit/report/synthetic_result.hpp"

namespace palpate {
namespace {

std::string json_report(const RecoveryResult& result, bool include_file_names = false,
                        FieldChoice fields = FieldChoice::one) {
    return tree_json(recovery_tree(result, include_file_names, fields));
}

nlohmann::json parsed(const RecoveryResult& result) {
    return nlohmann::json::parse(json_report(result));
}

TEST(RecoveryTree, DescribesOnlyDisplacementFilesThatAreThere) {
    const auto field = [](FieldChoice fields) {
        const std::string text = json_report(synthetic_result(), false, fields);
        return nlohmann::json::parse(text)["fields"][0];
    };

    const auto none = field(FieldChoice::none), one = field(FieldChoice::one),
               all = field(FieldChoice::all);

    for (const char* key :
         {"step_mm", "displacement_field", "itk_transform", "itk_transform_resamples"}) {
        EXPECT_TRUE(none.at(key).is_null()) << key;
        EXPECT_FALSE(all.at(key).is_null()) << key;
    }
    EXPECT_EQ(one["step_mm"], 1.0 / 128);
    EXPECT_TRUE(one["itk_transform_resamples"].is_null());
    EXPECT_EQ(one["grid_of"], "reference");
}

TEST(RecoveryTree, TellsWhereTheEndsOfAnIntervalAreFrom) {
    RecoveryResult result = synthetic_result();
    result.regions[1].seen_ends = {true, false};

    const nlohmann::json regions = parsed(result)["regions"];

    EXPECT_EQ(regions[1]["lower_end_from"], "images");
    EXPECT_EQ(regions[1]["upper_end_from"], "prior");
    EXPECT_TRUE(regions[0]["upper_end_from"].is_null());  // given
}

TEST(RecoveryTree, HoldsTheFieldsThatProgramsReadByName) {
    const nlohmann::json j = parsed(synthetic_result());

    EXPECT_EQ(j["version"], "0.1.0");
    ASSERT_EQ(j["regions"].size(), 6u);
    const auto& region = j["regions"][1];
    EXPECT_EQ(region["name"], "prostate, transition zone");
    EXPECT_EQ(region["label"], 1);
    EXPECT_EQ(region["role"], "tissue");
    EXPECT_EQ(region["stiffness_kpa"], 83.24);
    EXPECT_EQ(region["interval_kpa"], nlohmann::json({61.4, 112.8}));
    EXPECT_EQ(region["verdict"], "recovered");
    ASSERT_EQ(j["surfaces"].size(), 5u);
    for (const char* key : {"name", "dice_before", "dice_after", "mean_distance_mm_before",
                            "mean_distance_mm_after", "max_distance_mm_after"})
        EXPECT_TRUE(j["surfaces"][2].contains(key)) << key;
    EXPECT_EQ(j["surfaces"][3]["cut_by_image"], true);
    EXPECT_EQ(j["mesh"]["nodes"], 5 * (29 * 48 + 1));
    EXPECT_EQ(j["mesh"]["elements"], synthetic_result().mesh.num_elements());
    EXPECT_EQ(j["termination"]["converged"], true);
    EXPECT_EQ(j["termination"]["iterations"], 9);
    EXPECT_NEAR(j["timings_s"]["total"], 84.7, 1e-9);
    EXPECT_NEAR(j["timings_s"]["meshing"], 6.3, 1e-12);
    EXPECT_EQ(j["device"]["backend"], "opencl");
    EXPECT_EQ(j["linear_solver"]["condensing"]["method"], "direct");
    EXPECT_EQ(j["linear_solver"]["condensing"]["library"], "Eigen 3.4.0 LDLT");
    EXPECT_EQ(j["linear_solver"]["solving"]["backend"], "opencl");
    EXPECT_EQ(j["linear_solver"]["solving"]["reason"], "asked for");
    EXPECT_EQ(j["settings"]["background"]["stiffness_kpa"], 10.0);
    EXPECT_EQ(j["settings"]["organ"][0]["stiffness_kpa"], "unknown");
    EXPECT_EQ(j["settings"]["organ"][2]["hollow"], true);
    EXPECT_EQ(j["settings"]["prior"]["noise_voxels"], 0.11);
    EXPECT_EQ(j["settings"]["prior"]["contour_sd_mm"], "unknown");
    EXPECT_EQ(j["contours"]["sd_mm"], 0.42);
    EXPECT_EQ(j["contours"]["given"], false);
    EXPECT_EQ(j["alignment"]["method"], "fixed");
    EXPECT_EQ(j["correlation"]["ln_stiffness"][0][1], -0.42);
    EXPECT_EQ(j["correlation"]["regions"].size(), 2u);
    EXPECT_EQ(j["sensitivity"]["regions"].size(), 2u);
    EXPECT_EQ(j["sensitivity"]["combinations"][1]["scaled_singular_value"], 2.4);
    EXPECT_EQ(j["sensitivity"]["combinations"][1]["direction_ln_stiffness"][1], 0.97);
    EXPECT_EQ(j["profiles"][1]["name"], "prostate, peripheral zone");
    EXPECT_EQ(j["profiles"][0]["objective"].size(), 21u);
    EXPECT_EQ(j["convergence"].size(), 10u);
    EXPECT_EQ(j["warnings"].size(), 1u);
}

TEST(RecoveryTree, ASearchedPoissonRatioHasIntervalAndVerdict) {
    RecoveryResult result = synthetic_result();
    EXPECT_TRUE(parsed(result)["regions"][1]["searched_poisson_ratio"].is_null());

    result.regions[1].ratio = RatioResult{{0.38, 0.46}, Verdict::recovered, "narrow"};
    result.settings.organs[0].poisson_unknown = true;

    const nlohmann::json j = parsed(result);
    EXPECT_EQ(j["regions"][1]["searched_poisson_ratio"]["interval"], nlohmann::json({0.38, 0.46}));
    EXPECT_EQ(j["regions"][1]["searched_poisson_ratio"]["verdict"], "recovered");
    EXPECT_EQ(j["settings"]["organ"][0]["poisson_ratio"], "unknown");
    EXPECT_NE(j["summary"].dump().find("Poisson's ratio of prostate, transition zone"),
              std::string::npos);
}

TEST(RecoveryTree, TellsShearModuliOfWhatIsKnown) {
    RecoveryResult result = synthetic_result();
    result.regions[2].verdict = Verdict::not_identifiable;
    const nlohmann::json regions = parsed(result)["regions"];

    const double nu = result.regions[1].poisson_ratio;
    EXPECT_NEAR(regions[1]["shear_modulus_kpa"].get<double>(), 83.24 / (2 * (1 + nu)), 1e-12);
    EXPECT_NEAR(regions[1]["shear_modulus_interval_kpa"][0].get<double>(), 61.4 / (2 * (1 + nu)),
                1e-12);
    EXPECT_TRUE(regions[2]["shear_modulus_kpa"].is_null());
    EXPECT_TRUE(regions[3]["shear_modulus_kpa"].is_null());  // hollow
}

TEST(RecoveryTree, HollowRegionsHaveNoStiffness) {
    const nlohmann::json bladder = parsed(synthetic_result())["regions"][3];

    EXPECT_TRUE(bladder["stiffness_kpa"].is_null());
    EXPECT_TRUE(bladder["interval_kpa"][0].is_null());
    EXPECT_EQ(bladder["verdict"], "hollow");
}

TEST(RecoveryTree, NumbersThatAreNotFiniteAreNull) {
    RecoveryResult result = synthetic_result();
    result.regions[1].interval_kpa[1] = INFINITY;
    result.surfaces[0].dice_after = NAN;
    result.profiles[0].objective[3] = NAN;
    result.timings_s[0].second = NAN;

    const nlohmann::json j = parsed(result);

    EXPECT_TRUE(j["regions"][1]["interval_kpa"][1].is_null());
    EXPECT_TRUE(j["surfaces"][0]["dice_after"].is_null());
    EXPECT_TRUE(j["profiles"][0]["objective"][3].is_null());
    EXPECT_NEAR(j["timings_s"]["total"], 83.9, 1e-9);
    EXPECT_EQ(json_report(result).find("nan"), std::string::npos);
}

TEST(RecoveryTree, StagesThatRunTwiceAreAddedUp) {
    RecoveryResult result = synthetic_result();
    result.timings_s = {{"meshing", 1.0}, {"meshing", 2.5}};

    EXPECT_EQ(parsed(result)["timings_s"]["meshing"], 3.5);
}

TEST(RecoveryTree, KeepsFileNamesAndSettingsTextToItself) {
    EXPECT_EQ(json_report(synthetic_result()).find("SECRETPATIENT"), std::string::npos);
    EXPECT_NE(json_report(synthetic_result(), true).find("SECRETPATIENT_target"),
              std::string::npos);
}

TEST(RecoveryTree, TextThatIsNotUtf8IsRepairedInsteadOfThrown) {
    RecoveryResult result = synthetic_result();
    result.regions[1].name = "bad \xff name";

    EXPECT_EQ(parsed(result)["regions"][1]["name"], "bad \xef\xbf\xbd name");
}

TEST(RecoveryTree, IsTheSameBytesEveryTime) {
    EXPECT_EQ(json_report(synthetic_result()), json_report(synthetic_result()));
}

}  // namespace
}  // namespace palpate
