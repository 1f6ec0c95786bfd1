// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/modelling/settings.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

const std::string full_example = R"(
[background]
label = 5
stiffness_kpa = 10.0
poisson_ratio = 0.35
outer_boundary = "free"
[[organ]]
name = "prostate"
label = 1
role = "tissue"
stiffness_kpa = "unknown"
poisson_ratio = 0.41
[[organ]]
name = "bladder"
label = 2
role = "driven"
[[organ]]
name = "tumour"
label = 3
role = "driven"
hollow = false
stiffness_kpa = 40
[[organ]]
name = "bone"
label = 4
role = "fixed"
[prior]
noise_voxels = 0.3
stiffness_sd_ln = 1.0
)";

const std::string background = "[background]\nstiffness_kpa = 10\n";

std::string organ(const std::string& keys) {
    return "[[organ]]\nname = \"a\"\nlabel = 1\n" + keys + "\n";
}

/// The message with which `toml` is refused, which must come with `code`.
std::string complaint(const std::string& toml, ErrorCode code = ErrorCode::invalid_argument) {
    try {
        parse_settings(toml, "organs.toml");
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        return e.what();
    }
    ADD_FAILURE() << "accepted:\n" << toml;
    return {};
}

void expect_mentions(const std::string& message, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' not in: " << message;
}

TEST(Settings, ReadsEveryFieldOfTheExample) {
    const Settings s = parse_settings(full_example, "organs.toml");

    ASSERT_TRUE(s.background);
    EXPECT_EQ(s.background->label, 5);
    EXPECT_DOUBLE_EQ(s.background->stiffness_kpa, 10);
    EXPECT_DOUBLE_EQ(s.background->poisson_ratio, 0.35);
    EXPECT_FALSE(s.background->outer_boundary_fixed);
    ASSERT_EQ(s.organs.size(), 4u);
    EXPECT_EQ(s.organs[0].name, "prostate");
    EXPECT_EQ(s.organs[0].role, Role::tissue);
    EXPECT_FALSE(s.organs[0].stiffness_kpa);
    EXPECT_DOUBLE_EQ(s.organs[0].poisson_ratio, 0.41);
    EXPECT_EQ(s.organs[2].stiffness_kpa, 40);
    EXPECT_EQ(s.organs[3].label, 4);
    EXPECT_DOUBLE_EQ(s.prior.noise_voxels, 0.3);
    EXPECT_DOUBLE_EQ(s.prior.stiffness_sd_ln, 1.0);
    EXPECT_EQ(s.num_regions(), 6);
}

TEST(Settings, TheErrorOfContoursIsUnknownUnlessItIsSaid) {
    const auto sd_of = [](const std::string& toml) {
        const Settings read = parse_settings(full_example + toml, "organs.toml");
        EXPECT_EQ(to_toml(parse_settings(to_toml(read), "written")), to_toml(read));
        return read.prior.contour_sd_mm;
    };
    EXPECT_EQ(sd_of(""), std::nullopt);
    EXPECT_EQ(sd_of("contour_sd_mm = \"unknown\"\n"), std::nullopt);
    EXPECT_EQ(sd_of("contour_sd_mm = 0.5\n"), 0.5);
    EXPECT_EQ(sd_of("contour_sd_mm = 0\n"), 0.0);
}

TEST(Settings, HollowFollowsTheRoleUnlessItIsSaid) {
    const Settings s = parse_settings(full_example, "organs.toml");

    EXPECT_FALSE(s.organs[0].hollow);
    EXPECT_TRUE(s.organs[1].hollow);
    EXPECT_FALSE(s.organs[2].hollow);
    EXPECT_TRUE(s.organs[3].hollow);
}

TEST(Settings, DefaultsAreThoseOfTheHeader) {
    const Settings s = parse_settings(background + organ("role = \"driven\""), "organs.toml");

    EXPECT_FALSE(s.background->label);
    EXPECT_TRUE(s.background->outer_boundary_fixed);
    EXPECT_DOUBLE_EQ(s.prior.displacement_sd_mm, PriorSettings{}.displacement_sd_mm);
}

TEST(Settings, TextWrittenIsReadBackTheSame) {
    Settings s = parse_settings(full_example, "organs.toml");
    s.organs[0].name = "quo\"te \\ back";
    s.organs[2].stiffness_kpa = 1.0 / 3.0;

    const Settings t = parse_settings(to_toml(s), "written");

    EXPECT_EQ(to_toml(t), to_toml(s));
    EXPECT_EQ(t.organs[0].name, s.organs[0].name);
    EXPECT_EQ(t.organs[2].stiffness_kpa, s.organs[2].stiffness_kpa);
    EXPECT_EQ(t.organs[1].hollow, true);
    EXPECT_EQ(t.background->label, 5);
}

TEST(Settings, AnUnknownPoissonRatioIsReadAndWrittenAsSuch) {
    const std::string tissue = "role = \"tissue\"\nstiffness_kpa = 5\n";
    const Settings s = parse_settings("[background]\npoisson_ratio = \"unknown\"\n" +
                                          organ(tissue + "poisson_ratio = \"unknown\""),
                                      "organs.toml");
    EXPECT_TRUE(s.background->poisson_unknown);
    EXPECT_TRUE(s.organs[0].poisson_unknown);
    EXPECT_TRUE(s.has_unknown_poisson_ratio());
    EXPECT_TRUE(parse_settings(to_toml(s), "written").organs[0].poisson_unknown);

    const Settings known = parse_settings(full_example, "organs.toml");
    EXPECT_FALSE(known.has_unknown_poisson_ratio());
    EXPECT_EQ(to_toml(known).find("poisson_lowest"), std::string::npos);
    expect_mentions(complaint(background + organ(tissue + "poisson_ratio = \"soft\"")),
                    {"poisson_ratio", "soft", "unknown", "0.499"});
    expect_mentions(complaint("[prior]\npoisson_lowest = 0.4\npoisson_highest = 0.41\n" +
                              background + organ(tissue)),
                    {"poisson_highest", "0.02", "poisson_lowest"});
    expect_mentions(complaint("[prior]\npoisson_lowest = 0.48\n" + background + organ(tissue)),
                    {"poisson_lowest", "0.49", "0.02"});
    EXPECT_DOUBLE_EQ(parse_settings("[prior]\npoisson_lowest = 0.40\npoisson_highest = 0.42\n" +
                                        background + organ(tissue),
                                    "organs.toml")
                         .prior.poisson_highest,
                     0.42);
}

TEST(Settings, UnknownKeysAreRefusedWithAGuess) {
    expect_mentions(
        complaint(background + organ("rol = \"driven\"")),
        {"organs.toml", "line 6", "[[organ]] number 1", "'rol'", "did you mean 'role'"});
    expect_mentions(complaint("[[organs]]\n"), {"organs", "did you mean 'organ'"});
    expect_mentions(complaint("[background]\nstiffness = 1\n"), {"[background]", "stiffness_kpa"});
    expect_mentions(complaint("[prior]\nsigma = 1\n"), {"[prior]", "'sigma'", "noise_voxels"});
}

TEST(Settings, WrongTypesAreRefusedWithValueAndWhatIsAllowed) {
    expect_mentions(complaint("background = 3\n"), {"'background' is 3", "[background]"});
    expect_mentions(complaint("organ = 3\n"), {"'organ' is 3", "[[organ]]"});
    expect_mentions(complaint("[organ]\nname = \"a\"\n"), {"[[organ]]"});
    expect_mentions(complaint(background + "[[organ]]\nname = 7\n"), {"'name' is 7", "text"});
    expect_mentions(complaint(background + "[[organ]]\nname = \"a\"\nlabel = 1.5\n"),
                    {"'label' is 1.5", "1 to 65535"});
    expect_mentions(complaint(background + organ("role = \"drive\"")),
                    {"'role' is", "drive", "tissue", "driven", "fixed"});
    expect_mentions(complaint(background + organ("role = \"driven\"\nhollow = \"yes\"")),
                    {"'hollow' is", "true or false"});
    expect_mentions(complaint(background + organ("role = \"tissue\"\nstiffness_kpa = \"soft\"")),
                    {"soft", "unknown", "\"a\""});
}

TEST(Settings, ValuesOutOfRangeAreRefused) {
    const std::string tissue = "role = \"tissue\"\nstiffness_kpa = ";
    for (const char* value : {"0", "-3.0", "nan", "inf", "1e9"})
        expect_mentions(complaint(background + organ(tissue + value)), {"stiffness_kpa"});
    for (const char* value : {"0.5", "-0.1", "nan"})
        expect_mentions(complaint(background + organ(tissue + "5\npoisson_ratio = " + value)),
                        {"poisson_ratio", "0.499"});
    expect_mentions(complaint("[background]\nlabel = 70000\n"), {"label", "70000", "65535"});
    expect_mentions(complaint("[background]\nstiffness_kpa = \"unknown\"\n"), {"stiffness_kpa"});
    expect_mentions(complaint("[background]\nouter_boundary = \"loose\"\n"), {"fixed", "free"});
    expect_mentions(complaint("[prior]\nnoise_voxels = 0\n"), {"noise_voxels", "greater than 0"});
    for (const char* value : {"-0.1", "6", "\"small\"", "nan"})
        expect_mentions(complaint(std::string("[prior]\ncontour_sd_mm = ") + value + "\n"),
                        {"contour_sd_mm", "from 0 to 5", "unknown"});
}

TEST(Settings, MissingKeysAreNamed) {
    expect_mentions(complaint(background + "[[organ]]\nlabel = 1\n"), {"'name' is missing"});
    expect_mentions(complaint(background + "[[organ]]\nname = \"a\"\n"), {"'label' is missing"});
    expect_mentions(complaint(background + organ("")), {"'role' is missing", "driven"});
    expect_mentions(complaint(background + organ("role = \"tissue\"")),
                    {"'stiffness_kpa' is missing", "unknown"});
    expect_mentions(complaint(background + organ("role = \"driven\"\nhollow = false")),
                    {"'stiffness_kpa' is missing"});
    expect_mentions(complaint(background), {"[[organ]]"});
}

TEST(Settings, RolesAndHollownessMustAgree) {
    expect_mentions(complaint(background + organ("role = \"fixed\"\nhollow = false")),
                    {"'hollow' is false", "fixed"});
    expect_mentions(
        complaint(background + organ("role = \"tissue\"\nhollow = true\nstiffness_kpa = 5")),
        {"'hollow' is true", "tissue"});
    expect_mentions(complaint(background + organ("role = \"driven\"\nstiffness_kpa = 5")),
                    {"stiffness_kpa", "hollow = false"});
}

TEST(Settings, NamesAndLabelsMustDiffer) {
    const std::string driven = "role = \"driven\"\n";
    expect_mentions(
        complaint(background + organ(driven) + "[[organ]]\nname = \"a\"\nlabel = 2\n" + driven),
        {"'name' is", "names must differ"});
    expect_mentions(
        complaint(background + organ(driven) + "[[organ]]\nname = \"b\"\nlabel = 1\n" + driven),
        {"'label' is 1", "organ \"a\"", "labels must differ"});
    expect_mentions(complaint("[background]\nlabel = 1\n" + organ(driven)),
                    {"background", "labels must differ"});
}

TEST(Settings, AReferenceTissueIsNeeded) {
    expect_mentions(complaint(organ("role = \"tissue\"\nstiffness_kpa = \"unknown\"")),
                    {"no reference tissue", "[background]"});
    expect_mentions(complaint(organ("role = \"driven\"")), {"nothing to mesh", "tissue"});
    EXPECT_NO_THROW(parse_settings(organ("role = \"tissue\"\nstiffness_kpa = 5"), "organs.toml"));
}

TEST(Settings, NamesThatWouldBreakATableAreRefused) {
    expect_mentions(complaint(background + "[[organ]]\nname = \"\"\n"), {"'name' is", "1 to 64"});
    expect_mentions(complaint(background + "[[organ]]\nname = \"a\\nb\"\n"), {"printable"});
    expect_mentions(complaint(background + "[[organ]]\nname = \"" + std::string(65, 'x') + "\"\n"),
                    {"1 to 64"});
}

TEST(Settings, TextThatIsNotTomlIsRefusedWithItsLine) {
    expect_mentions(complaint("[background]\nlabel = = 3\n", ErrorCode::input_unreadable),
                    {"organs.toml", "line 2"});
    complaint(std::string(100000, '['), ErrorCode::input_unreadable);
    complaint("[background]\n[background]\n", ErrorCode::input_unreadable);
}

class SettingsFile : public ::testing::Test {
protected:
    void SetUp() override {
        path = std::filesystem::temp_directory_path() /
               ("palpate_settings_" + std::to_string(::getpid()) + ".toml");
    }
    void TearDown() override { std::filesystem::remove(path); }
    std::string refusal() {
        try {
            read_settings(path);
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::input_unreadable);
            return e.what();
        }
        return "accepted";
    }
    std::filesystem::path path;
};

TEST_F(SettingsFile, IsReadFromDisk) {
    std::ofstream(path) << full_example;

    EXPECT_EQ(read_settings(path).organs.size(), 4u);
}

TEST_F(SettingsFile, ThatIsMissingOrTooLargeIsRefused) {
    expect_mentions(refusal(), {"no such settings file"});
    std::ofstream(path) << std::string((1 << 20) + 1, '\n');
    expect_mentions(refusal(), {"1 MiB"});
}

}  // namespace
}  // namespace palpate
