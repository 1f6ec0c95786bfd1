// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/recover/modelling/body_mesh.hpp"
#include "host/apps/recover/modelling/settings.hpp"
#include "solver/model/solid_model.hpp"

namespace palpate {

/// The part of an organ's surface that is seen in both images: no caps.
struct ObservedSurface {
    Index region = 0;
    bool driven = false;
    Surface surface;             ///< vertices in reference position, mm LPS
    std::vector<Index> node_of;  ///< mesh node of each vertex
    bool cut_by_image = false;   ///< a part of the organ's surface lies on the image box
};

/// The forward model of the inverse problem: which nodes are fixed, driven, observed, free.
struct RecoveryModel {
    /// Linear elasticity, materials by region number; fixed and driven dofs prescribed.
    SolidModel model;
    std::vector<Index> fixed;     ///< nodes with zero displacement, ascending
    std::vector<Index> driven;    ///< nodes with unknown displacement and force, ascending
    std::vector<Index> observed;  ///< free nodes on tissue surfaces, ascending
    std::vector<ObservedSurface> surfaces;  ///< of tissue and driven organs, in settings order
    std::vector<Index> unknown;             ///< regions whose modulus is unknown, ascending
    std::vector<Index> unknown_ratio;       ///< regions whose Poisson's ratio is, ascending
};

/// Node sets (method.md section 1). Where several apply: fixed organ before driven organ before
/// observed tissue before the fixed outer boundary, so that an organ cut by the image may still
/// move. Unknown moduli start at the prior median. Throws Error(input_unusable) if nothing is
/// observed, or a piece of meshed tissue touches neither a fixed nor a driven node (its rigid
/// motion would be undetermined).
RecoveryModel build_model(const BodyMesh& mesh, const Settings& settings);

/// Prior median of unknown moduli, kPa: settings.prior.stiffness_median_ratio x reference tissue.
double prior_median_kpa(const Settings& settings);

}  // namespace palpate
