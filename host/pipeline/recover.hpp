// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "host/imaging/label_image.hpp"
#include "host/inverse/map_estimate.hpp"
#include "host/inverse/nested_lbfgs.hpp"
#include "host/meshing/mesher.hpp"
#include "host/modelling/alignment.hpp"
#include "host/modelling/settings.hpp"
#include "host/modelling/tissue_law.hpp"
#include "host/pipeline/mechanics.hpp"
#include "host/result/joint_result.hpp"
#include "host/result/recovery_result.hpp"
#include "host/surfaces/surface.hpp"
#include "solver/base/error.hpp"
#include "solver/linear/linear_solver.hpp"

namespace palpate {

/// How moduli and wall motion are searched.
enum class SearchMethod {
    map,           ///< the most probable ones, with intervals
    nested_lbfgs,  ///< the published baseline, without intervals
};

struct RecoverOptions {
    Settings settings;
    MesherOptions mesher;
    std::filesystem::path mesh;  ///< ready mesh (.vtu with `region` labels) or empty
    AlignMethod align = AlignMethod::automatic;  ///< fixed organs if there are any, else centroids
    std::filesystem::path
        initial_transform;  ///< rigid ITK transform, reference to target, or empty
    LinearSolverOptions solver;
    MechanicsOptions mechanics;
    SearchMethod method = SearchMethod::map;
    TissueLaw law = TissueLaw::linear;
    MapOptions search;
    NestedOptions nested;                ///< for `nested_lbfgs`
    std::vector<Landmark> landmarks;     ///< measured at the end, not used by the search
    std::filesystem::path save_reduced;  ///< file for the mesh and the reduced model, or empty
    /// Such a file, used instead of meshing and condensing, or empty. `mesh` and `mesher` are then
    /// not read. Another reference or other settings than it was saved for: Error(input_unusable).
    std::filesystem::path load_reduced;
};

/// A label volume and what messages and reports call it.
struct Segmentation {
    LabelImage labels;
    std::string name;
    std::vector<std::string> warnings = {};  ///< sentences about what is odd in its file
};

Segmentation read_segmentation(const std::filesystem::path& path,
                               const ProgressSink& progress = {});

/// Whether both have the same labels at the same places.
bool is_same(const Segmentation& a, const Segmentation& b);

/// The surface of one organ, which may be open, or points on it, mm LPS.
struct OrganTarget {
    std::string organ;  ///< its name in the settings
    std::string name;   ///< for messages and the report
    std::variant<Surface, std::vector<Vec3>> shape;
};

/// A target of which no label volume exists. Organs that are not given, and what a shape does not
/// show of one, carry no data.
struct PartialTarget {
    std::vector<OrganTarget> organs;
    double noise_mm = 0.5;  ///< standard deviation of its points about the organs' surfaces
};

/// Receives the result of each target, in order, and the seconds that it took beyond what is done
/// once for all targets.
using ResultSink =
    std::function<void(std::size_t target, RecoveryResult result, double own_seconds)>;

/// Receives the error that ended the work on one target.
using FailureSink = std::function<void(std::size_t target, const Error& error)>;

using JointSink = std::function<void(JointResult result)>;

/// Who is told what of several targets.
struct TargetSinks {
    ResultSink result;
    FailureSink failed = {};  ///< empty: errors of one target go to the caller
    JointSink joint = {};     ///< empty: no joint estimate
};

/// The main job: two segmentations in, moduli, forces, field and error bars out (style.md section
/// 1). Throws Error with the codes of each station, Error(invalid_argument) for options that do not
/// go together; not converging is reported in the result.
RecoveryResult recover(const Segmentation& reference, const Segmentation& target,
                       const RecoverOptions& options, const ProgressSink& progress = {});

/// The same for a target made of surfaces and points. It is in the reference's frame unless
/// `options.initial_transform` says otherwise. Dice and labels on a target grid do not exist then.
/// Throws Error(invalid_argument) for organs that are unknown, fixed or given twice and for options
/// that need a label volume, Error(input_unusable) for a shape of another size or place than its
/// organ.
RecoveryResult recover(const Segmentation& reference, const PartialTarget& target,
                       const RecoverOptions& options, const ProgressSink& progress = {});

/// The same for several targets of one reference, which is meshed and condensed once. All targets
/// are read and aligned before that, so that a wrong one is told early. An Error while one target
/// is searched or its sink runs goes to `failed`, and the next target follows. Where two targets or
/// more were searched by `map`, with the linear law and given ratios, a joint estimate follows of
/// those that converged and whose labels are neither the reference's nor an earlier target's.
void recover_all(const Segmentation& reference, const std::vector<Segmentation>& targets,
                 const RecoverOptions& options, const TargetSinks& tell,
                 const ProgressSink& progress = {});

}  // namespace palpate
