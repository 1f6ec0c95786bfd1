// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "host/imaging/label_image.hpp"
#include "host/meshing/mesher.hpp"
#include "host/modelling/settings.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

struct PelvisOptions {
    unsigned seed = 1;                 ///< anatomy and load; the same seed gives the same phantom
    double stiffness_kpa = 80;         ///< of the prostate, 1..10000
    double poisson_ratio = 0.40;       ///< of the prostate
    double background_stiffness_kpa = 10;
    double background_poisson_ratio = 0.35;
    Vec3 spacing{1, 1, 1};             ///< mm, of the label volumes written
    Index num_nodes = 30000;           ///< of the mesh that the truth is solved on
};

/// A patient with known answers: irregular prostate, hollow bladder and rectum pushing on it, two
/// fixed bones, a box of background tissue.
struct PelvisPhantom {
    Settings settings;
    LabelImage reference, target;       ///< voxelised from the undeformed and the deformed mesh
    RegionMesh mesh;
    std::vector<Vec3> displacement;     ///< [num_nodes] mm
    std::vector<Vec3> landmarks;        ///< points inside the prostate, LPS mm, reference
    std::vector<Vec3> landmark_displacements;
};

PelvisPhantom make_pelvis(const PelvisOptions& options, const LinearSolverOptions& solver,
                          const MesherOptions& mesher, const ProgressSink& progress = {});

/// Writes reference.nii.gz target.nii.gz organs.toml truth.json landmarks.csv into a new folder
/// `folder`, all or nothing. Throws Error(output_failed).
void write_pelvis(const PelvisPhantom& phantom, const PelvisOptions& options,
                  const std::filesystem::path& folder);

}  // namespace palpate
