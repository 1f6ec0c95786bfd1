// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solver/base/types.hpp"

namespace palpate {

/// A quantity that surfaces have at their vertices, and its colours.
struct ShownField {
    std::string name = {};
    std::string unit = {};
    /// Ends of the colour scale that can be chosen, ascending; the last is shown at first.
    std::vector<double> ranges{1};
    bool is_signed = false;             ///< from -range to range; else from 0 to range
    bool is_displacement = false;       ///< the length of the displacement: surfaces hold no values
    std::string left = {}, right = {};  ///< beside the colour scale; empty: name and unit
};

struct TriangleShape {
    std::vector<Vec3> vertices = {};  ///< mm
    std::vector<Triangle> triangles = {};
};

struct SurfaceInView {
    std::string name = {}, colour = {};  ///< "#rrggbb"
    bool is_shown = true;                ///< at first
    bool is_plain = false;               ///< it has its own colour always, and no outline
    bool is_inside = false;              ///< it has an outline only while those round it are hidden
    bool is_glass = false;               ///< translucent
    TriangleShape shape = {};
    /// [states][vertices] mm; an empty one is 0.
    std::vector<std::vector<Vec3>> displacement = {};
    /// [fields][states][vertices]; NaN: not known there. An empty state is 0, an empty field none.
    std::vector<std::vector<std::vector<double>>> values = {};
    std::optional<TriangleShape> outline =
        {};  ///< drawn beside it; none: as it is in the first state
};

/// Surfaces that can be turned and enlarged, between their states in a row.
struct SurfaceView {
    std::string label = {};                ///< what screen readers say
    std::vector<std::string> states = {};  ///< names; the first is at rest
    std::size_t first = 0;                 ///< the state shown at first
    std::vector<ShownField> fields = {};
    std::string plain_name = {};    ///< of the surfaces' own colours as a choice; empty: no choice
    std::string outline_name = {};  ///< as a control; empty: no outlines
    std::vector<SurfaceInView> surfaces = {};
    std::string note = {};           ///< HTML of the caption
    std::string without_webgl = {};  ///< what to look at instead
    bool has_rest_beside = false;    ///< two panes, the first always at rest
    bool is_patient = false;         ///< LPS axes: directions have the names of patients'
    bool has_creases = false;        ///< sharp edges are such, and lines; the mesh can be shown
    bool has_static = false;         ///< the page has pictures for paper
    double azimuth = -0.55, elevation = 0.32;
    double factor = 1;                   ///< displacements are drawn so many times as large
    std::size_t most_triangles = 60000;  ///< beyond, surfaces are thinned and the caption says so
};

/// Round values that offer ranges of a field that is as large as `largest`.
std::vector<double> round_ranges(double largest);
/// The value below which this part of the absolute values lies; 0 of none. NaN do not count.
double quantile_of_sizes(std::vector<double> values, double part);

/// The element that `startSurfaceViewers` of `surface_viewer_script` makes a viewer of, with all
/// its data; nothing without surfaces. It is not seen where scripts do not run.
std::string surface_viewer_html(const SurfaceView& view);
std::string surface_viewer_script();

}  // namespace palpate
