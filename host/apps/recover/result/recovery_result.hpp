// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/apps/recover/inverse/records.hpp"
#include "host/apps/recover/modelling/alignment.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "host/apps/recover/modelling/tissue_law.hpp"
#include "host/apps/recover/result/landmark.hpp"
#include "host/estimate/verdict.hpp"
#include "host/geometry/meshing/mesher.hpp"
#include "host/geometry/surfaces/surface.hpp"
#include "host/io/label_image.hpp"
#include "solver/equilibrium/element_loops.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// What is known about a Poisson's ratio that was searched.
struct RatioResult {
    std::array<double, 2> interval{0, 0};  ///< 95 %
    Verdict verdict = Verdict::not_judged;
    std::string reason;  ///< one sentence in words
};

/// What is known about one region after a recovery.
struct RegionResult {
    Index region = 0;
    std::string name;
    Index label = 0;
    Role role = Role::tissue;
    bool hollow = false;
    bool unknown = false;  ///< its modulus was estimated
    double poisson_ratio = 0;
    double stiffness_kpa = 0;                  ///< estimated or given; 0 for hollow regions
    std::array<double, 2> interval_kpa{0, 0};  ///< 95 % interval; equal ends for a given modulus
    double sd_ln = 0;                          ///< posterior sd of ln E
    Verdict verdict = Verdict::not_judged;     ///< if not judged, interval and sd are NaN
    std::string reason;                        ///< one sentence in words
    std::optional<RatioResult> ratio = std::nullopt;  ///< if Poisson's ratio was unknown
    // Of a region that is not hollow:
    std::array<double, 2> jacobian_range{1, 1};  ///< of its elements' volumes, after over before
    double strain_energy_mj = 0;
    /// Whether the images give the lower and the upper end of `interval_kpa`; an end that they do
    /// not give is what was assumed beforehand.
    std::array<bool, 2> seen_ends{true, true};
    /// Moduli at which searches that began elsewhere have ended, where they are another answer.
    std::vector<double> other_answers_kpa = {};
    double most_probable_kpa = 0;  ///< with which fields and forces are; as given where it is
    /// The images say what was hardly expected: something else may have moved the contours.
    bool contradicts_prior = false;
};

/// One combination of unknown moduli and how much the images say of it.
struct SensitivityResult {
    /// Of the observed distances over their noise with respect to ln E over its prior standard
    /// deviation, the wall motion projected out: the images narrow the prior along this direction
    /// by the factor 1 / sqrt(1 + s^2).
    double singular_value = 0;
    std::vector<double> direction;  ///< unit length, by unknown region in order
};

/// Agreement of one organ's surface with its target, before (aligned) and after.
struct SurfaceResult {
    Index region = 0;
    std::string name;
    Role role = Role::tissue;
    std::string target_kind = "labels";      ///< "surface", "points" or "none": not given
    double seen_share = 1;                   ///< of its area: the part that carries data
    double dice_before = 0, dice_after = 0;  ///< NaN without target labels
    // Over the part that was seen; NaN if nothing was.
    double mean_distance_mm_before = 0, mean_distance_mm_after = 0;
    double max_distance_mm_before = 0, max_distance_mm_after = 0;
    double hausdorff95_mm_before = 0, hausdorff95_mm_after = 0;  ///< `measure_agreement`
    bool cut_by_image = false;
    Vec3 resultant_force_mn = Vec3::Zero();  ///< sum of the reactions on a driven organ, mN, LPS
    /// Its standard deviation per component, mN, at the estimated moduli; zero if not computed.
    Vec3 resultant_sd_mn = Vec3::Zero();
    // For pictures. `reference` has the vertex numbers of the mesh in `node_of`; without caps.
    Surface reference;
    std::vector<Index> node_of;
    std::vector<double> distance_before_mm;  ///< signed, per vertex of `reference`, before
    std::vector<double> distance_after_mm;
    std::vector<std::uint8_t> seen;  ///< per vertex: whether the target says anything about it
    Surface target;                  ///< aligned, without caps; small marks in place of points
};

/// How far the contours of one image are off, smoothly along each surface or slice by slice.
struct ContourError {
    double sd_mm = 0;
    double length_mm = 0;    ///< of its correlation (Matern 3/2)
    bool is_given = false;   ///< by the settings; else found from how the surfaces fit
    int images = 2;          ///< 1: the target is of surfaces or points, whose noise is given
    double point_scale = 1;  ///< how often what voxels leave each point is off by itself
    bool is_most = false;    ///< as far as is looked for
    double slice_share = 0;  ///< of their variance: each slice off by itself
};

/// What holds a node of the mesh.
enum class Held : std::uint8_t {
    free,    ///< nothing but the tissue round it
    fixed,   ///< it does not move
    driven,  ///< on the wall of a driven organ: it moves as estimated, and a force acts on it
};

struct RecoveryResult {
    Settings settings;
    std::string settings_toml;
    std::string reference_name, target_name;  ///< file names only, no folders
    std::string version;
    TissueLaw law;  ///< of all tissue
    std::string seed_note;
    SolidMesh mesh;                  ///< LPS mm, tet4 or tet10
    std::vector<Vec3> displacement;  ///< [num_nodes] mm, reference to aligned target
    /// Root mean square of what elements of no size would change of the displacement of the
    /// organs' surfaces, as the search counted it, mm; empty: it did not.
    std::optional<double> mesh_change_mm;
    std::vector<Vec3> force;  ///< [num_nodes] mN, reactions at driven and fixed nodes
    std::vector<Held> held;   ///< [num_nodes]
    std::vector<double> element_stiffness_kpa;  ///< [num_elements]
    std::vector<RegionResult> regions;
    std::vector<std::vector<double>> correlation;  ///< of ln E, unknown regions in order
    std::vector<SensitivityResult> sensitivity;    ///< largest first; empty if not computed
    std::vector<SurfaceResult> surfaces;
    std::optional<ContourError> contours;   ///< empty where the search looks for none
    std::vector<LandmarkResult> landmarks;  ///< those that were given, in order
    std::vector<ProfileResult> profiles;
    std::vector<IterationRecord> convergence;
    AlignmentResult alignment;
    Termination termination;
    MesherSummary mesher;
    BackendInfo device;                                                    ///< of the final solve
    std::vector<std::pair<std::string, LinearSolverInfo>> linear_solvers;  ///< by stage
    std::optional<ElementLoopInfo> element_loops;  ///< of Newton's method; none at small strains
    double full_model_residual = 0;  ///< relative residual of the final solve, fp64 on host
    std::vector<std::pair<std::string, double>> timings_s;  ///< stages in order; total is added
    std::vector<std::string> warnings;

    // Volumes on the target's grid; without target labels on the reference's, moved by the
    // alignment.
    LabelImage reference_labels;       ///< carried there by the alignment alone
    LabelImage target_labels_aligned;  ///< the target as it was read; empty without target labels
    LabelImage warped_labels;          ///< reference labels carried by the displacement
    Image<Vec3> inverse_displacement_field;  ///< mm, LPS, target to reference (alignment included)
    // On the reference grid.
    Image<Vec3> displacement_field;  ///< mm, LPS, reference to target (alignment included)
};

}  // namespace palpate
