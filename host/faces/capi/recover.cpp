// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/recover.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "host/apps/recover/report/recovery_tree.hpp"
#include "host/apps/recover/report/result_folder.hpp"
#include "host/faces/capi/guard.hpp"
#include "host/faces/capi/handles.hpp"
#include "host/faces/capi/solver_options.hpp"
#include "host/io/grid_check.hpp"
#include "host/page/tree_json.hpp"
#include "solver/base/large_blocks.hpp"

using namespace palpate;
using capi::completed;
using capi::guarded;
using capi::hold;
using capi::require;

/// The handle.
struct palpate_result {
    RecoveryResult result;
    ResultTree tree;
    std::string json;
};

namespace {

// Results are given out as plain arrays.
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Index) == sizeof(std::int32_t));

/// Its texts are views into `figure`.
palpate_figure c_figure(const Figure& figure, std::size_t struct_size) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    palpate_figure full{struct_size, figure.unit.c_str(), none, "", {none, none}, "", ""};
    if (const auto* number = std::get_if<double>(&figure.value)) full.value = *number;
    if (const auto* count = std::get_if<std::int64_t>(&figure.value))
        full.value = static_cast<double>(*count);
    if (const auto* is_so = std::get_if<bool>(&figure.value)) full.value = *is_so;
    if (const auto* words = std::get_if<std::string>(&figure.value)) full.text = words->c_str();
    if (figure.interval_95)
        std::copy(figure.interval_95->begin(), figure.interval_95->end(), full.interval_95);
    if (figure.verdict) full.verdict = name_of(*figure.verdict);
    full.reason = figure.reason.c_str();
    return full;
}

Segmentation segmentation_of(const palpate_labels& given, const char* usual_name) {
    require(given.voxels, "the array of voxels");
    Segmentation segmentation;
    segmentation.name = given.name && *given.name ? given.name : usual_name;
    ImageGrid& grid = segmentation.labels.grid;
    for (int i = 0; i < 3; ++i) {
        grid.size[i] = given.size[i];
        grid.origin[i] = given.origin[i];
        grid.spacing[i] = given.spacing[i];
        for (int j = 0; j < 3; ++j) grid.direction(i, j) = given.direction[3 * i + j];
    }
    grid = checked_grid(grid);
    segmentation.labels.voxels.assign(given.voxels, given.voxels + grid.num_voxels());
    return segmentation;
}

RecoverOptions recover_options(const palpate_recover_options& given) {
    require(given.settings_toml, "the text of the settings");
    RecoverOptions options;
    options.settings = parse_settings(given.settings_toml, "settings");
    if (given.align) options.align = align_method_of(given.align);
    if (given.mesh_program) options.mesher.program = given.mesh_program;
    if (given.num_nodes != 0 && given.num_nodes < 500)
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("a mesh of {} nodes is too coarse; at least 500 are needed",
                                given.num_nodes));
    if (given.num_nodes > 0) options.mesher.num_nodes = given.num_nodes;
    if (given.mesh) options.mesh = given.mesh;
    if (given.element) options.element = recovery_element_of(given.element);
    if (given.material) options.law = tissue_law_of(given.material);
    options.solver = capi::linear_solver_options(given.solver);
    return options;
}

template <class Read>
palpate_status recovered(const palpate_recover_options* options, palpate_result** result,
                         Read&& read) {
    return guarded([&] {
        require(result, "the place for the result");
        *result = nullptr;
        keep_large_blocks();
        const auto chosen =
            completed(options, palpate_recover_options_init, "the options of the recovery");
        const RecoverOptions inner = recover_options(chosen);
        const ProgressSink progress = capi::progress_sink(chosen.progress, chosen.progress_user);
        const auto [reference, target] = read(progress);
        auto made = std::make_unique<palpate_result>();
        made->result = recover(reference, target, inner, progress);
        made->tree = recovery_tree(made->result);
        made->json = tree_json(made->tree);
        const bool converged = made->result.termination.converged;
        if (!converged) capi::last_error() = "the search did not converge";
        *result = capi::Handles<palpate_result>::all().keep(std::move(made));
        return converged ? PALPATE_OK : PALPATE_NOT_CONVERGED;
    });
}

}  // namespace

void palpate_labels_init(palpate_labels* labels) {
    if (!labels) return;
    *labels = {};
    labels->struct_size = sizeof *labels;
    for (int i = 0; i < 3; ++i) labels->spacing[i] = labels->direction[4 * i] = 1;
}

void palpate_recover_options_init(palpate_recover_options* options) {
    if (!options) return;
    *options = {};
    options->struct_size = sizeof *options;
}

palpate_status palpate_recover(const palpate_labels* reference, const palpate_labels* target,
                               const palpate_recover_options* options, palpate_result** result) {
    return recovered(options, result, [&](const ProgressSink&) {
        return std::pair(
            segmentation_of(completed(reference, palpate_labels_init, "the reference"),
                            "reference"),
            segmentation_of(completed(target, palpate_labels_init, "the target"), "target"));
    });
}

palpate_status palpate_recover_files(const char* reference_path, const char* target_path,
                                     const palpate_recover_options* options,
                                     palpate_result** result) {
    return recovered(options, result, [&](const ProgressSink& progress) {
        require(reference_path, "the path of the reference");
        require(target_path, "the path of the target");
        return std::pair(read_segmentation(reference_path, progress),
                         read_segmentation(target_path, progress));
    });
}

palpate_status palpate_result_free(palpate_result* result) {
    return guarded([&] {
        capi::release(result, "the result");
        return PALPATE_OK;
    });
}

std::int32_t palpate_result_num_regions(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? static_cast<std::int32_t>(body->result.regions.size()) : 0;
}

palpate_status palpate_result_region(const palpate_result* result, std::int32_t index,
                                     palpate_region* region) {
    return guarded([&] {
        const auto held = hold(result, "the result");
        require(region, "the place for the region");
        const std::size_t count = result->result.regions.size();
        if (index < 0 || static_cast<std::size_t>(index) >= count)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("there is no region {}; there are {}", index, count));
        const std::size_t size = region->struct_size;
        if (size < sizeof(std::size_t) || size > 4096)
            throw Error(ErrorCode::invalid_argument, "the region has no struct_size");
        const RegionResult& found = result->result.regions[static_cast<std::size_t>(index)];
        const palpate_region full{size,
                                  found.name.c_str(),
                                  found.label,
                                  name_of(found.role),
                                  name_of(found.verdict),
                                  found.reason.c_str(),
                                  found.stiffness_kpa,
                                  {found.interval_kpa[0], found.interval_kpa[1]},
                                  found.poisson_ratio,
                                  found.most_probable_kpa};
        std::memcpy(region, &full, std::min(size, sizeof full));
        return PALPATE_OK;
    });
}

palpate_status palpate_result_figure(const palpate_result* result, const char* path,
                                     palpate_figure* figure) {
    return guarded([&] {
        const auto held = hold(result, "the result");
        require(path, "the path of the figure");
        require(figure, "the place for the figure");
        const std::size_t size = figure->struct_size;
        if (size < sizeof(std::size_t) || size > 4096)
            throw Error(ErrorCode::invalid_argument, "the figure has no struct_size");
        const Figure* found = find_figure(held->tree, path);
        if (!found)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("there is no figure '{}'; paths are those of result.json, as "
                                    "\"regions/0/stiffness_kpa\"",
                                    path));
        const palpate_figure full = c_figure(*found, size);
        std::memcpy(figure, &full, std::min(size, sizeof full));
        return PALPATE_OK;
    });
}

std::int32_t palpate_result_num_nodes(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.mesh.num_nodes() : 0;
}

std::int32_t palpate_result_num_elements(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.mesh.num_elements() : 0;
}

std::int32_t palpate_result_nodes_per_element(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.mesh.table().num_nodes : 0;
}

const double* palpate_result_nodes(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.mesh.nodes.front().data() : nullptr;
}

const double* palpate_result_displacement(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.displacement.front().data() : nullptr;
}

const double* palpate_result_force(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.force.front().data() : nullptr;
}

const std::int32_t* palpate_result_elements(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.mesh.elements.data() : nullptr;
}

const double* palpate_result_stiffness(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->result.element_stiffness_kpa.data() : nullptr;
}

const double* palpate_result_field(const palpate_result* result, std::int32_t size[3]) {
    const auto body = capi::found(result);
    if (!body) return nullptr;
    const Image<Vec3>& field = body->result.displacement_field;
    if (size)
        for (int i = 0; i < 3; ++i) size[i] = field.grid.size[i];
    return field.voxels.empty() ? nullptr : field.voxels.front().data();
}

const char* palpate_result_json(const palpate_result* result) {
    const auto body = capi::found(result);
    return body ? body->json.c_str() : "";
}

palpate_status palpate_result_write(const palpate_result* result, const char* folder) {
    return palpate_result_write_with(result, folder, nullptr);
}

void palpate_write_options_init(palpate_write_options* options) {
    if (!options) return;
    *options = {};
    options->struct_size = sizeof *options;
}

palpate_status palpate_result_write_with(const palpate_result* result, const char* folder,
                                         const palpate_write_options* options) {
    return guarded([&] {
        const auto held = hold(result, "the result");
        require(folder, "the path of the folder");
        ResultOptions writing;
        if (options) {
            const auto chosen =
                completed(options, palpate_write_options_init, "the options of writing");
            if (chosen.fields) writing.fields = field_choice_of(chosen.fields);
        }
        write_result(result->result, folder, writing);
        return PALPATE_OK;
    });
}
