// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/phantom/contour_error.hpp"
#include "host/apps/phantom/deform.hpp"
#include "host/apps/phantom/wall_motion.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "host/io/label_image.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

struct PelvisOptions {
    unsigned seed = 1;            ///< anatomy and load; the same seed gives the same phantom
    double stiffness_kpa = 80;    ///< of the prostate, 1..10000
    double poisson_ratio = 0.40;  ///< of the prostate
    double background_stiffness_kpa = 10;
    double background_poisson_ratio = 0.35;
    Vec3 spacing{1, 1, 1};         ///< mm, of the label volumes written
    ContourErrorOptions contours;  ///< how both label volumes are drawn
    Index num_nodes = 30000;       ///< of the mesh that the truth is solved on
    /// Of that mesh, tet4 or tet10. Linear tetrahedra of this size are too stiff by a few
    /// hundredths (organs are found that much too soft), quadratic ones of as many nodes are not.
    ElementType element = ElementType::tet4;
    double tangential_factor = 1;  ///< on the walls' motion along themselves
    LoadFamily load = LoadFamily::mixed;
    AnatomyFamily anatomy = AnatomyFamily::usual;
    double tumour_fraction = 0;  ///< of the prostate's volume that is tumour, 0..0.95; no label
    double tumour_stiffness_kpa = 100;
    /// Of transition and peripheral zone, 1..10000, which get labels of their own in place of the
    /// one prostate; empty: one zone of `stiffness_kpa`.
    std::optional<std::array<double, 2>> zone_stiffness_kpa;
    double load_factor = 1;  ///< on all walls' motion, -1..1; 0: nothing moves, -1: the other way
    unsigned target = 1;     ///< 1..1000; each is drawn anew, the reference is drawn alike for all
    TissueLaw law;           ///< of all tissue
};

/// What was asked of one wall, and the force that it took.
struct WallTruth {
    std::string name;
    double expansion_mm = 0;   ///< mean motion along the outward normal
    double push_mm = 0;        ///< more of it where the wall faces the prostate
    double tangential_mm = 0;  ///< amplitude of the motion along the wall
    Vec3 shift_mm = Vec3::Zero();
    Vec3 resultant_force_mn = Vec3::Zero();  ///< sum of the nodal forces on the wall, LPS
};

struct PelvisTruth {
    unsigned load = 1;  ///< number of the load
    LoadFamily load_family = LoadFamily::mixed;
    std::vector<WallTruth> walls;  ///< lengths before `load_scale`
    double load_scale = 1;         ///< on all wall motions, so that no tet is crushed
    double smallest_jacobian = 1;  ///< smallest det(I + grad u) of all tets
    double peak_displacement_mm = 0;
    double prostate_mean_displacement_mm = 0;
    double prostate_shape_change_mm = 0;  ///< rms of what its best rigid motion leaves
    double prostate_largest_shape_change_mm = 0;
    double solve_residual = 0;  ///< relative
    MesherSummary mesher;
};

/// A patient with known answers: irregular prostate, hollow bladder and rectum pushing on it, two
/// fixed bones, a box of background tissue.
struct PelvisPhantom {
    Settings settings;
    LabelImage reference, target;    ///< voxelised from the undeformed and the deformed mesh
    RegionMesh mesh;                 ///< of tet4; where the truth is solved on tet10, eight of each
    std::vector<Vec3> displacement;  ///< [num_nodes] mm
    std::vector<Vec3> landmarks;     ///< points inside the prostate, LPS mm, reference
    std::vector<Vec3> landmark_displacements;
    PelvisTruth truth;
    ElementType element = ElementType::tet4;  ///< that the truth is solved on
};

/// Steps: random implicit shapes, a fine label volume of them, surfaces, a mesh, prescribed motion
/// of the bladder and rectum walls (filling, emptying, a push towards the prostate, a small
/// tangential part), equilibrium, and voxels from the undeformed and the deformed mesh.
/// A tumour is part of the prostate in labels and mesh; only the truth is solved with it. Zones are
/// regions of labels, mesh and settings: "peripheral_zone" (label 1) and "transition_zone" (6).
/// `solver`, `mesher` give the means; size and edge lengths of the mesh come from `options`.
/// Throws Error(invalid_argument) for an option out of range, and what meshing and solving throw.
PelvisPhantom make_pelvis(const PelvisOptions& options, const LinearSolverOptions& solver,
                          const MesherOptions& mesher, const ProgressSink& progress = {});

using PelvisSink = std::function<void(const PelvisPhantom& phantom)>;

/// The patient of `make_pelvis` under the loads 1 to `num_loads`, one after the other to `take`:
/// mesh and reference stay, motion, target, landmarks' displacements and truth are of the load.
/// Load 1 is that of the seed; the family of each is drawn anew where `options.load` says so, and
/// so are the contours of each target. `options.target` has no meaning here.
/// Throws what `make_pelvis` does, and what `take` throws.
void make_pelvis_loads(const PelvisOptions& options, unsigned num_loads,
                       const LinearSolverOptions& solver, const MesherOptions& mesher,
                       const PelvisSink& take, const ProgressSink& progress = {});

/// The undeformed mesh of the same phantom alone.
RegionMesh make_pelvis_mesh(const PelvisOptions& options, const MesherOptions& mesher,
                            const ProgressSink& progress = {});

/// The forward problem of the same phantom, not solved: for benchmarks of the solver.
WallProblem make_pelvis_problem(const PelvisOptions& options, const MesherOptions& mesher,
                                const ProgressSink& progress = {});

/// Writes reference.nii.gz target.nii.gz organs.toml truth.json landmarks.csv, and
/// target_<organ>.ply (the deformed surface of each organ that is not fixed, mm LPS) into a new
/// folder `folder`, all or nothing. Throws Error(output_failed).
void write_pelvis(const PelvisPhantom& phantom, const PelvisOptions& options,
                  const std::filesystem::path& folder);

/// The same of several loads, which `for_each` hands over. The folder holds reference.nii.gz,
/// organs.toml, pairs.tsv (a table for `palpate cohort plan`) and for each load a folder target-01,
/// target-02, ... with the other files.
void write_pelvis_loads(const PelvisOptions& options,
                        const std::function<void(const PelvisSink& take)>& for_each,
                        const std::filesystem::path& folder);

}  // namespace palpate
