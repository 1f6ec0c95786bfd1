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
    for (const std::string& program : program_names()) {
        const auto file = folder / (program + ".cl");
        std::ofstream(file) << program_text(program);
        const bool has_variants = program_text(program).find("CONSTRAINED") != std::string::npos;
        // Real and wide types, device kind, column width.
        for (const char* types :
             {"-DREAL_IS_DOUBLE=0 -DHAS_DOUBLE=0", "-DREAL_IS_DOUBLE=0 -DHAS_DOUBLE=1",
              "-DREAL_IS_DOUBLE=1 -DHAS_DOUBLE=1"})
            for (const char* layout :
                 {"-DDEVICE_IS_CPU=0 -DCOLUMN_WIDTH=1", "-DDEVICE_IS_CPU=1 -DCOLUMN_WIDTH=1",
                  "-DDEVICE_IS_CPU=1 -DCOLUMN_WIDTH=16"})
                for (int constrained = 0; constrained <= (has_variants ? 1 : 0); ++constrained)
                    script += fmt::format(
                        "{} -x cl -cl-std=CL1.2 -target spir64-unknown-unknown -fsyntax-only "
                        "-Xclang -fdeclare-opencl-builtins -Xclang -finclude-default-header "
                        "-Wall -Wextra -Wno-unused-function -Wno-unused-parameter -Werror {} {} "
                        "-DCONSTRAINED={} {}\n",
                        PALPATE_CLANG, types, layout, constrained, file.string());
    }
    std::ofstream(folder / "check.sh") << script;

    const int status =
        std::system(fmt::format("sh {0}/check.sh > {0}/log 2>&1", folder.string()).c_str());

    std::ifstream log(folder / "log");
    EXPECT_EQ(status, 0) << log.rdbuf();
    std::filesystem::remove_all(folder);
}

TEST(KernelText, UnknownProgramIsAnError) { EXPECT_THROW(program_text("no_such_loop"), Error); }

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
