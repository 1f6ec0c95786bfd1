// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "host/apps/phantom/pelvis.hpp"
#include "host/faces/capi/guard.hpp"
#include "host/faces/capi/handles.hpp"
#include "host/faces/capi/solver_options.hpp"

using namespace palpate;
using capi::completed;
using capi::guarded;
using capi::require;

/// The handle.
struct palpate_phantom {
    PelvisPhantom phantom;
    std::string settings;
};

void palpate_phantom_options_init(palpate_phantom_options* options) {
    if (!options) return;
    const PelvisOptions defaults;
    *options = {};
    options->struct_size = sizeof *options;
    options->seed = defaults.seed;
    options->stiffness_kpa = defaults.stiffness_kpa;
    options->background_stiffness_kpa = defaults.background_stiffness_kpa;
    for (int i = 0; i < 3; ++i) options->spacing[i] = defaults.spacing[i];
    options->num_nodes = defaults.num_nodes;
}

palpate_status palpate_phantom_pelvis(const palpate_phantom_options* options,
                                      palpate_phantom** phantom) {
    return guarded([&] {
        require(phantom, "the place for the phantom");
        *phantom = nullptr;
        palpate_phantom_options chosen;
        palpate_phantom_options_init(&chosen);
        if (options)
            chosen = completed(options, palpate_phantom_options_init, "the phantom's options");
        PelvisOptions pelvis;
        pelvis.seed = chosen.seed;
        pelvis.stiffness_kpa = chosen.stiffness_kpa;
        pelvis.background_stiffness_kpa = chosen.background_stiffness_kpa;
        pelvis.spacing = Vec3(chosen.spacing[0], chosen.spacing[1], chosen.spacing[2]);
        pelvis.num_nodes = chosen.num_nodes;
        MesherOptions mesher;
        if (chosen.mesh_program) mesher.program = chosen.mesh_program;
        if (chosen.material) pelvis.law = tissue_law_of(chosen.material);
        const LinearSolverOptions solver = capi::linear_solver_options(chosen.solver);
        auto made = std::make_unique<palpate_phantom>();
        made->phantom = make_pelvis(pelvis, solver, mesher,
                                    capi::progress_sink(chosen.progress, chosen.progress_user));
        made->settings = to_toml(made->phantom.settings);
        *phantom = capi::Handles<palpate_phantom>::all().keep(std::move(made));
        return PALPATE_OK;
    });
}

palpate_status palpate_phantom_free(palpate_phantom* phantom) {
    return guarded([&] {
        capi::release(phantom, "the phantom");
        return PALPATE_OK;
    });
}

palpate_status palpate_phantom_labels(const palpate_phantom* phantom, std::int32_t state,
                                      palpate_labels* labels) {
    return guarded([&] {
        const auto held = capi::hold(phantom, "the phantom");
        require(labels, "the place for the labels");
        if (state != 0 && state != 1)
            throw Error(ErrorCode::invalid_argument,
                        fmt::format("a phantom has no state {}; there are 0, the reference, and 1, "
                                    "the target",
                                    state));
        const std::size_t size = labels->struct_size;
        if (size < sizeof(std::size_t) || size > 4096)
            throw Error(ErrorCode::invalid_argument, "the labels have no struct_size");
        const LabelImage& image = state == 0 ? phantom->phantom.reference : phantom->phantom.target;
        palpate_labels full;
        palpate_labels_init(&full);
        full.struct_size = size;
        for (int i = 0; i < 3; ++i) {
            full.size[i] = image.grid.size[i];
            full.origin[i] = image.grid.origin[i];
            full.spacing[i] = image.grid.spacing[i];
            for (int j = 0; j < 3; ++j) full.direction[3 * i + j] = image.grid.direction(i, j);
        }
        full.voxels = image.voxels.data();
        full.name = state == 0 ? "reference" : "target";
        std::memcpy(labels, &full, std::min(size, sizeof full));
        return PALPATE_OK;
    });
}

const char* palpate_phantom_settings(const palpate_phantom* phantom) {
    const auto body = capi::found(phantom);
    return body ? body->settings.c_str() : "";
}
