// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/measured_data.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host/apps/identify/data_kinds.hpp"
#include "tests/unit/report/temporary_folder.hpp"
#include "tests/unit/simulation/model_text.hpp"

namespace palpate {
namespace {

class MeasuredDataTest : public TemporaryFolderTest {
protected:
    std::unique_ptr<MeasuredData> data(const std::string& keys, const std::string& csv) {
        std::ofstream(folder / "m.csv") << csv;
        tables = std::make_unique<DataTables>(folder);
        document = SettingsTable::parse("[[data]]\nfile = \"m.csv\"\n" + keys, "e.toml");
        return read_data(document->tables("data")[0], 1, *tables);
    }

    /// Nearly incompressible: mu 2 kPa, gamma 5.
    static std::vector<MaterialSettings> tissue(std::vector<RelaxationTerm> relaxation = {}) {
        MaterialSettings one;
        one.material = {"veronda-westmann", {2, 5, 1e6}, std::move(relaxation)};
        one.material.relaxation_of = RelaxationOf::isochoric;
        return {one};
    }

    /// P = 2 mu exp(gamma x) (l - l^-2), x = l^2 + 2/l - 3.
    static double uniaxial(double l) {
        return 2 * 2 * std::exp(5 * (l * l + 2 / l - 3)) * (l - 1 / (l * l));
    }

    std::unique_ptr<DataTables> tables;
    std::optional<SettingsTable> document;
};

TEST_F(MeasuredDataTest, UniaxialStressIsThatOfTheClosedForm) {
    const auto found = data("kind = \"stress-stretch\"\nsd_kpa = 0.1\n",
                            "stretch,stress_kpa\n0.8,0\n1,0\n1.1,0\n1.3,0\n");
    const auto materials = tissue();
    const Eigen::VectorXd stress = found->predicted({materials});
    const std::vector<double> stretch{0.8, 1, 1.1, 1.3};
    for (int k = 0; k < 4; ++k)
        EXPECT_NEAR(stress[k], uniaxial(stretch[k]), 1e-4 * std::abs(stress[k]) + 1e-9);
}

TEST_F(MeasuredDataTest, EquibiaxialAndShearStressAreThoseOfTheClosedForms) {
    const auto materials = tissue();
    // Pulled two ways: x = 2 l^2 + l^-4 - 3, P = 2 mu e^(gamma x) (l - l^-5).
    const auto two = data("kind = \"stress-stretch\"\nmode = \"equibiaxial\"\nsd_kpa = 0.1\n",
                          "stretch,stress_kpa\n1.1,0\n");
    const double l = 1.1, x = 2 * l * l + std::pow(l, -4) - 3;
    EXPECT_NEAR(two->predicted({materials})[0], 2 * 2 * std::exp(5 * x) * (l - std::pow(l, -5)),
                1e-3);
    // Sheared: x = k^2, P_12 = 2 mu e^(gamma k^2) k.
    const auto shear = data("kind = \"stress-stretch\"\nmode = \"shear\"\nsd_kpa = 0.1\n",
                            "shear,stress_kpa\n0.3,0\n");
    EXPECT_NEAR(shear->predicted({materials})[0], 2 * 2 * std::exp(5 * 0.09) * 0.3, 1e-9);
}

TEST_F(MeasuredDataTest, StressOfAHeldStretchRelaxesToThatOfTheLaw) {
    const auto materials = tissue({{0.5, 2}});
    const auto found = data("kind = \"stress-stretch\"\nsd_kpa = 0.1\n",
                            "time_s,stretch,stress_kpa\n0.001,1.2,0\n2.001,1.2,0\n100,1.2,0\n");
    const Eigen::VectorXd stress = found->predicted({materials});
    const double rest = uniaxial(1.2);
    EXPECT_NEAR(stress[0], 1.5 * rest, 1e-3 * rest);
    EXPECT_NEAR(stress[1], (1 + 0.5 * std::exp(-1)) * rest, 1e-3 * rest);
    EXPECT_NEAR(stress[2], rest, 1e-3 * rest);
}

TEST_F(MeasuredDataTest, ModuliOfASuddenStrainAndRelaxationOfAllStressAreHeard) {
    const auto found = data("kind = \"stress-stretch\"\nsd_kpa = 0.1\n",
                            "time_s,stretch,stress_kpa\n0.001,1.2,0\n2.001,1.2,0\n100,1.2,0\n");
    auto materials = tissue({{0.5, 2}});
    const Eigen::VectorXd isochoric = found->predicted({materials});
    materials[0].material.is_instantaneous = true;
    const Eigen::VectorXd instantaneous = found->predicted({materials});
    EXPECT_LT((1.5 * instantaneous - isochoric).norm(), 1e-12 * isochoric.norm());
    EXPECT_NEAR(instantaneous[0], uniaxial(1.2), 1e-3 * uniaxial(1.2));

    // Held, both relax alike; on the way back up [f l^2 / l_3^2] is not [f] l^2 / l_3^2.
    const auto moved = data("kind = \"stress-stretch\"\nsd_kpa = 0.1\n",
                            "time_s,stretch,stress_kpa\n0.001,1.4,0\n1,1.4,0\n1.001,1.1,0\n");
    materials = tissue({{0.5, 2}});
    const double of_shape = moved->predicted({materials})[2];
    materials[0].material.relaxation_of = RelaxationOf::total;
    EXPECT_GT(std::abs(moved->predicted({materials})[2] - of_shape), 0.01 * std::abs(of_shape));
}

TEST_F(MeasuredDataTest, TimesThatRunBackAreNamed) {
    expect_refused(
        [&] {
            data("kind = \"stress-stretch\"\nsd_kpa = 1\n",
                 "time_s,stretch,stress_kpa\n1,1.1,1\n0.5,1.2,1\n");
        },
        {"m.csv, line 3", "ascend"}, ErrorCode::input_unreadable);
    expect_refused(
        [&] { data("kind = \"relaxation\"\nsd = 1\nbegin_s = 2\n", "time_s,force_mn\n1,5\n"); },
        {"m.csv, line 2", "begin_s"}, ErrorCode::input_unreadable);
}

TEST_F(MeasuredDataTest, ForceOfAHeldToolFallsWithTheTerms) {
    const auto materials = tissue({{0.5, 2}, {0.2, 10}});
    const auto found = data(
        "kind = \"relaxation\"\ngain = 3\nbegin_s = 1\nsd = 0.1\ncolumn = \"f\"\nunit = \"N\"\n",
        "time_s,f\n1,5\n4,4\n");
    const Eigen::VectorXd force = found->predicted({materials});
    EXPECT_EQ(found->block().unit, "N");
    EXPECT_NEAR(force[0], 3 * 1.7, 1e-12);
    EXPECT_NEAR(force[1], 3 * (1 + 0.5 * std::exp(-1.5) + 0.2 * std::exp(-0.3)), 1e-12);
}

TEST_F(MeasuredDataTest, NoiseIsANumberOrAColumn) {
    EXPECT_EQ(
        data("kind = \"stress-stretch\"\n", "stretch,stress_kpa,sd_kpa\n1.1,1,0.2\n1.2,2,0.4\n")
            ->block()
            .sd,
        Eigen::Vector2d(0.2, 0.4));
    expect_refused([&] { data("kind = \"stress-stretch\"\n", "stretch,stress_kpa\n1.1,1\n"); },
                   {"sd_kpa"});
    expect_refused(
        [&] { data("kind = \"stress-stretch\"\n", "stretch,stress_kpa,sd_kpa\n1.1,1,0\n"); },
        {"m.csv, line 2", "not above 0"}, ErrorCode::input_unreadable);
}

TEST_F(MeasuredDataTest, MissingColumnsAndStretchesBelowZeroAreNamed) {
    expect_refused(
        [&] { data("kind = \"stress-stretch\"\nsd_kpa = 1\n", "strain,stress_kpa\n0.1,1\n"); },
        {"stretch", "strain, stress_kpa"}, ErrorCode::input_unreadable);
    expect_refused(
        [&] { data("kind = \"stress-stretch\"\nsd_kpa = 1\n", "stretch,stress_kpa\n-0.1,1\n"); },
        {"line 2", "not above 0"}, ErrorCode::input_unreadable);
}

}  // namespace
}  // namespace palpate
