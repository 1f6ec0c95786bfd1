// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "solver/backends/opencl/kernel_text.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

// What no driver of this machine may show: a mistake in a combination that PoCL does not use.
TEST(KernelSyntax, EveryCombinationPassesClangAsOpenclC12) {
    if (std::string(PALPATE_CLANG).empty() ||
        std::string(PALPATE_CLANG).find("NOTFOUND") != std::string::npos)
        GTEST_SKIP() << "clang was not found when the build was configured.";
    const auto folder =
        std::filesystem::temp_directory_path() / fmt::format("palpate-syntax-{}", getpid());
    std::filesystem::create_directories(folder);
    std::string script = "set -e\n";
    std::vector<std::pair<std::string, std::string>> combinations;
    for (const std::string& program : program_names())
        for (const std::string& law : laws_of_program(program)) {
            // material_point has every law; loops over elements one of small strains and one not.
            const bool is_loop = program.starts_with("solid_");
            if (!is_loop || law == "linear" || law == "neo-hookean")
                combinations.emplace_back(program, law);
        }
    for (const auto& [program, law] : combinations) {
        const auto file = folder / (program + "-" + law + ".cl");
        const std::string text = program_text(program, law);
        std::ofstream(file) << text;
        // Every define that the program knows, with all its values.
        std::vector<std::string> variants = {""};
        for (const auto& [define, values] :
             std::initializer_list<std::pair<const char*, std::vector<int>>>{
                 {"CONSTRAINED", {0, 1}},
                 {"RECOMPUTED", {0, 1}},
                 {"MODE", {0, 1, 2, 3}},
                 {"HAS_SUM", {0, 1}},
                 {"BLOCK_ROWS", program == "gather_to_nodes" ? std::vector{3} : std::vector{3, 6}},
                 {"BLOCK_COLUMNS", {3, 6}},
                 {"NODES_PER_ELEMENT", {10}},
                 {"POINTS_PER_ELEMENT", {4}},
                 {"HAS_HOOP", {0, 1}},
                 {"HAS_MEAN_VOLUME", {0, 1}}}) {
            const bool is_known = text.find(define) != std::string::npos;
            if (!is_known || text.find(fmt::format("#define {} ", define)) != std::string::npos)
                continue;
            std::vector<std::string> more;
            for (const std::string& variant : variants)
                for (int value : values)
                    more.push_back(fmt::format("{} -D{}={}", variant, define, value));
            variants = std::move(more);
        }
        const std::string mixed = "-DREAL_IS_DOUBLE=0 -DHAS_DOUBLE=1";
        const std::vector<std::string> layouts = {"-DDEVICE_IS_CPU=0 -DCOLUMN_WIDTH=1",
                                                  "-DDEVICE_IS_CPU=1 -DCOLUMN_WIDTH=16",
                                                  "-DDEVICE_IS_CPU=1 -DCOLUMN_WIDTH=1"};
        std::vector<std::string> options;
        // Real and wide types on every kind of device once, then every variant in mixed precision.
        for (const std::string& types : {std::string("-DREAL_IS_DOUBLE=0 -DHAS_DOUBLE=0"), mixed,
                                         std::string("-DREAL_IS_DOUBLE=1 -DHAS_DOUBLE=1")})
            for (const std::string& layout : layouts)
                options.push_back(types + " " + layout + variants.back());
        for (const std::string& layout : layouts)
            for (const std::string& variant : variants)
                options.push_back(mixed + " " + layout + variant);
        if (program == "conjugate_gradients") options.push_back(mixed + " -DLANES=1 " + layouts[1]);
        for (const std::string& option : options)
            script += fmt::format(
                "{} -x cl -cl-std=CL1.2 -target spir64-unknown-unknown -fsyntax-only "
                "-Xclang -fdeclare-opencl-builtins -Xclang -finclude-default-header "
                "-Wall -Wextra -Wno-unused-function -Wno-unused-parameter -Werror {} {}\n",
                PALPATE_CLANG, option, file.string());
    }
    std::ofstream(folder / "check.sh") << script;

    const int status =
        std::system(fmt::format("sh {0}/check.sh > {0}/log 2>&1", folder.string()).c_str());

    std::ifstream log(folder / "log");
    EXPECT_EQ(status, 0) << log.rdbuf();
    std::filesystem::remove_all(folder);
}

TEST(KernelText, UnknownProgramIsAnError) { EXPECT_THROW(program_text("no_such_loop"), Error); }

TEST(KernelText, UnknownLawIsAnError) {
    EXPECT_THROW(program_text("material_point", "no-such-law"), Error);
}

TEST(KernelText, StartsWithTheNumberTypesAndEndsWithTheLoop) {
    const std::string text = program_text("stiffness_apply");

    const auto real = text.find("REAL_IS_DOUBLE");
    const auto tensor = text.find("tensor3");
    const auto element = text.find("NODES_PER_ELEMENT");
    const auto material = text.find("material_stress");
    const auto loop = text.find("void stiffness_apply");
    EXPECT_LT(real, tensor);
    EXPECT_LT(tensor, element);
    EXPECT_LT(element, material);
    EXPECT_LT(material, loop);
    EXPECT_NE(loop, std::string::npos);
}

}  // namespace
}  // namespace palpate
