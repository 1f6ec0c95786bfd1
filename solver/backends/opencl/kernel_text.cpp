// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/backends/opencl/kernel_text.hpp"

#include <algorithm>

#include "solver/base/error.hpp"
#include "solver/materials/registry.hpp"

namespace palpate {
namespace {

std::string_view file_text(std::string_view name) {
    for (const EmbeddedFile& file : embedded_kernels())
        if (file.name == name) return {reinterpret_cast<const char*>(file.bytes), file.size};
    throw Error(ErrorCode::internal,
                "The kernel file " + std::string(name) +
                    " is not embedded: list it in solver/backends/opencl/CMakeLists.txt.");
}

/// The files of a law in the order in which they need each other; its own is named after it.
std::string material_text(std::string_view law) {
    std::string own = "materials/" + std::string(material_law(law).name) + ".cl";
    std::replace(own.begin(), own.end(), '-', '_');
    if (law == "linear") return std::string(file_text(own));
    std::string text(file_text("materials/finite_strain.cl"));
    text += file_text("materials/reduced_invariants.cl");
    text += file_text(own);
    text += file_text("materials/finite_strain_law.cl");
    return text;
}

/// Loops over the elements of large deformation, of any element and law.
bool is_solid(std::string_view program) { return program.starts_with("solid_"); }

}  // namespace

const std::vector<std::string>& program_names() {
    static const std::vector<std::string> names = {
        "conjugate_gradients", "diagonal_blocks",  "element_geometry", "gather_blocks",
        "gather_to_nodes",     "inverse_diagonal", "material_point",   "multiply_blocks",
        "parameter_gradient",  "solid_force",      "solid_parameters", "solid_product",
        "solid_tangent",       "stiffness_apply",  "stiffness_blocks", "vector_ops"};
    return names;
}

std::vector<std::string> laws_of_program(std::string_view program) {
    if (program != "material_point" && !is_solid(program)) return {"linear"};
    std::vector<std::string> names;
    for (const MaterialDescription& law : material_laws()) names.emplace_back(law.name);
    return names;
}

std::string program_text(std::string_view program, std::string_view law) {
    const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
        return std::find(names.begin(), names.end(), program) != names.end();
    };
    const bool over_parts = is_one_of(
        {"conjugate_gradients", "gather_to_nodes", "inverse_diagonal", "multiply_blocks"});
    std::string text(file_text("real.cl"));
    if (over_parts) text += file_text("parts.cl");
    if (is_one_of({"gather_to_nodes", "multiply_blocks"})) text += file_text("row_result.cl");
    if (!over_parts && !is_one_of({"gather_blocks", "vector_ops"})) {
        text += file_text("tensor3.cl");
        if (program != "material_point" && !is_solid(program))
            text += file_text("elements/tet4.cl");
        text += material_text(law);
        if (is_solid(program)) {
            text += file_text("solid_element.cl");
            text += file_text("solid_response.cl");
        }
    }
    text += file_text(std::string(program) + ".cl");
    return text;
}

}  // namespace palpate
