// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/linear/linear_solver.hpp"
#include "solver/model/model.hpp"

namespace palpate {

/// A ball inside a shell that sticks to it, pressed from outside.
struct SpheresOptions {
    double inner_radius_mm = 30;
    double outer_radius_mm = 37.5;
    LinearElastic inner{50, 0.40};
    LinearElastic outer{10, 0.35};
    double pressure_kpa = 1;  ///< on the outer surface; positive: it presses inwards
};

/// Radial displacement (mm) at radius r (mm), in closed form: Lame's u = A r in the ball and
/// u = C r + D / r^2 in the shell (Timoshenko and Goodier, Theory of Elasticity, 1970, section
/// 136), with equal displacement and radial stress where they meet and stress -p outside.
double sphere_displacement_mm(const SpheresOptions& options, double r);

/// Radius of the surface between ball and shell under the pressure, closed form, mm.
double pressed_inner_radius_mm(const SpheresOptions& options);

/// One octant (x, y, z >= 0) in `layers` layers of tets, a multiple of 5 so that the boundary
/// between ball (region 0) and shell (region 1) lies on one of them with the default radii; the
/// symmetry planes are held across. The layers are equally thick within ball and shell.
Model spheres_model(const SpheresOptions& options, Index layers);

/// The same radius from finite elements: the mean over the nodes of the inner surface.
/// Throws Error(solve_failed) if the solver misses its tolerance.
double solved_inner_radius_mm(const SpheresOptions& options, Index layers,
                              const LinearSolverOptions& solver);

}  // namespace palpate
