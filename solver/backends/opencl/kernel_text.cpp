// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/kernel_text.hpp"

#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::string_view file_text(std::string_view name) {
    for (const EmbeddedFile& file : embedded_kernels())
        if (file.name == name) return {reinterpret_cast<const char*>(file.bytes), file.size};
    throw Error(ErrorCode::internal,
                "The kernel file " + std::string(name) +
                    " is not embedded: list it in solver/backends/opencl/CMakeLists.txt.");
}

}  // namespace

const std::vector<std::string>& program_names() {
    static const std::vector<std::string> names = {
        "block_csr",        "block_jacobi",     "diagonal_blocks",
        "element_geometry", "gather_to_nodes",  "parameter_gradient",
        "stiffness_apply",  "stiffness_blocks", "vector_ops"};
    return names;
}

std::string program_text(std::string_view program) {
    const bool node_loop = program == "block_csr" || program == "block_jacobi" ||
                           program == "gather_to_nodes" || program == "vector_ops";
    std::string text(file_text("real.cl"));
    if (!node_loop) {
        text += file_text("tensor3.cl");
        text += file_text("elements/tet4.cl");
        text += file_text("materials/linear.cl");
    }
    text += file_text(std::string(program) + ".cl");
    return text;
}

}  // namespace palpate
