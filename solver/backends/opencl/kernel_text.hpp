// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// One file of `kernels/`, embedded at build time (scripts/cmake/embed_kernels.cmake).
struct EmbeddedFile {
    std::string_view name;  ///< relative to `kernels/`: "elements/tet4.cl"
    const unsigned char* bytes;
    unsigned long size;
};

const std::vector<EmbeddedFile>& embedded_kernels();

/// The loops over elements or nodes that make a program: "solid_force", "stiffness_apply", ...
const std::vector<std::string>& program_names();

/// The laws (solver/materials/registry.hpp) that a program can be made with.
std::vector<std::string> laws_of_program(std::string_view program);

/// Complete text of a program: real.cl, tensor3.cl, element, material, loop, in that order.
/// Throws Error(internal) for an unknown program, Error(invalid_argument) for an unknown law.
std::string program_text(std::string_view program, std::string_view law = "linear");

}  // namespace palpate
