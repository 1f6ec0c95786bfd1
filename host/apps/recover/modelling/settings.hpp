// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// What an organ does in the inverse problem (method.md section 1).
enum class Role {
    tissue,      ///< meshed; its surface is observed and carries no force
    driven,      ///< its surface carries unknown forces and is observed
    fixed,       ///< does not move
    background,  ///< the tissue round all organs; no organ has this role
};
const char* name_of(Role role);

struct OrganSettings {
    std::string name;
    Index label = 0;
    Role role = Role::tissue;
    bool hollow = false;                  ///< default: true for driven and fixed
    std::optional<double> stiffness_kpa;  ///< empty: unknown
    double poisson_ratio = 0.40;          ///< if it is unknown, where its search starts
    bool poisson_unknown = false;
};

struct BackgroundSettings {
    std::optional<Index> label;  ///< empty: everything that is no organ
    double stiffness_kpa = 10.0;
    double poisson_ratio = 0.35;
    bool poisson_unknown = false;
    bool outer_boundary_fixed = true;
};

/// Of contours: farther off they would not show the organ.
constexpr double largest_contour_sd_mm = 5;

/// Priors and noise of the MAP estimate; every field has a default that suits millimetre voxels.
struct PriorSettings {
    double noise_voxels = 0.11;  ///< sigma_n as a fraction of the mean voxel spacing
    /// Standard deviation (mm) of how far whoever drew the contours of one image was off, along
    /// 7 mm in the same direction. Empty: found from how the surfaces fit.
    std::optional<double> contour_sd_mm;
    /// Whether they were drawn slice by slice, each off by itself, and not smooth along the
    /// surface. Empty: found from how the surfaces fit.
    std::optional<bool> drawn_by_slice;
    double displacement_sd_mm = 5.0;       ///< sd of the driven displacement, each component
    double displacement_range_mm = 40.0;   ///< distance at which its correlation has dropped to 0.1
    double stiffness_median_ratio = 10.0;  ///< prior median of unknown moduli over the reference
    double stiffness_sd_ln = 1.2;          ///< sigma_theta: sd of ln E
    /// Unknown Poisson's ratios are equally likely between these two.
    double poisson_lowest = 0.25, poisson_highest = 0.49;
};

struct Settings {
    std::optional<BackgroundSettings> background;  ///< empty: only organs are meshed
    std::vector<OrganSettings> organs;             ///< region number = 2 + position
    PriorSettings prior;

    Index num_regions() const { return 2 + static_cast<Index>(organs.size()); }
    bool has_unknown_poisson_ratio() const;
};

/// "unknown", "surface" or "slices": `contour_style` of the settings.
const char* contour_style_name(const PriorSettings& prior);

/// Reads TOML. Throws Error(input_unreadable) (missing or not TOML, with line) and
/// Error(invalid_argument) naming table, key, value and allowed values; unknown keys are errors.
Settings read_settings(const std::filesystem::path& path);
Settings parse_settings(const std::string& toml, const std::string& source_name);
/// The TOML text that `parse_settings` turns into `settings` again.
std::string to_toml(const Settings& settings);

}  // namespace palpate
