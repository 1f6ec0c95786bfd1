// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/phantom/spheres.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <map>

#include "solver/base/error.hpp"
#include "solver/linear/make_linear_solver.hpp"

namespace palpate {
namespace {

double bulk_modulus(const LinearElastic& m) {
    return m.stiffness_kpa * (m.unit_lambda() + 2.0 / 3.0 * m.unit_mu());
}

double shear_modulus(const LinearElastic& m) { return m.stiffness_kpa * m.unit_mu(); }

/// (A, C, D) of u = A r in the ball and u = C r + D / r^2 in the shell; sigma_rr there is
/// 3 K A and 3 K C - 4 G D / r^3.
Vec3 lame_coefficients(const SpheresOptions& o) {
    const double a3 = std::pow(o.inner_radius_mm, 3), b3 = std::pow(o.outer_radius_mm, 3);
    const double g = shear_modulus(o.outer), k = bulk_modulus(o.outer);
    Mat3 conditions;
    conditions << 1, -1, -1 / a3,                       // displacement at the inner surface
        3 * bulk_modulus(o.inner), -3 * k, 4 * g / a3,  // stress there
        0, 3 * k, -4 * g / b3;                          // stress outside
    return conditions.inverse() * Vec3(0, 0, -o.pressure_kpa);
}

/// A lattice point of the ordered simplex n >= i >= j >= k >= 0. Its layer is i; the octant's
/// directions (x, y, z) are proportional to (i - j, j - k, k).
using LatticePoint = std::array<Index, 3>;

class OctantBuilder {
public:
    OctantBuilder(const SpheresOptions& options, Index layers)
        : options_(options), layers_(layers), inner_layers_(layers * 4 / 5) {}

    Mesh build() {
        for (Index i = 0; i < layers_; ++i)
            for (Index j = 0; j <= i; ++j)
                for (Index k = 0; k <= j; ++k) add_cube({i, j, k});
        return std::move(mesh_);
    }

private:
    /// The tets of a lattice cube (one for each order of its three steps) that lie in the simplex.
    void add_cube(const LatticePoint& corner) {
        static constexpr int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                             {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
        for (const auto& order : orders) {
            std::array<LatticePoint, 4> points{corner, corner, corner, corner};
            bool is_inside = true;
            for (int p = 1; p < 4; ++p) {
                points[p] = points[p - 1];
                ++points[p][order[p - 1]];
                is_inside = is_inside && is_in_simplex(points[p]);
            }
            if (is_inside) add_tet(points, corner[0] < inner_layers_ ? 0 : 1);
        }
    }

    bool is_in_simplex(const LatticePoint& p) const {
        return p[0] <= layers_ && p[0] >= p[1] && p[1] >= p[2];
    }

    void add_tet(const std::array<LatticePoint, 4>& points, Index region) {
        Tet tet;
        for (int c = 0; c < 4; ++c) tet[c] = node_at(points[c]);
        mesh_.tets.push_back(tet);
        mesh_.region.push_back(region);
        if (tet_volume(mesh_, mesh_.num_tets() - 1) < 0)
            std::swap(mesh_.tets.back()[2], mesh_.tets.back()[3]);
    }

    Index node_at(const LatticePoint& p) {
        const auto [at, is_new] = numbers_.try_emplace(p, mesh_.num_nodes());
        if (is_new) mesh_.nodes.push_back(position(p));
        return at->second;
    }

    Vec3 position(const LatticePoint& p) const {
        if (p[0] == 0) return Vec3::Zero();
        return radius_of(p[0]) * Vec3(p[0] - p[1], p[1] - p[2], p[2]).normalized();
    }

    double radius_of(Index layer) const {
        const double a = options_.inner_radius_mm, b = options_.outer_radius_mm;
        if (layer <= inner_layers_) return a * layer / inner_layers_;
        return a + (b - a) * (layer - inner_layers_) / (layers_ - inner_layers_);
    }

    const SpheresOptions& options_;
    Index layers_, inner_layers_;
    Mesh mesh_;
    std::map<LatticePoint, Index> numbers_;
};

/// Forces of the pressure on the faces whose nodes all lie on the outer surface, [num_dofs, 1] mN:
/// a third of pressure times area goes to each node.
Columns pressure_forces(const Model& model, const SpheresOptions& options) {
    Columns forces = Columns::Zero(model.num_dofs(), 1);
    const Mesh& mesh = model.mesh;
    const auto is_outer = [&](Index n) {
        return mesh.nodes[n].norm() > options.outer_radius_mm * (1 - 1e-9);
    };
    for (const Tet& tet : mesh.tets)
        for (int skip = 0; skip < 4; ++skip) {
            const Triangle face{tet[(skip + 1) % 4], tet[(skip + 2) % 4], tet[(skip + 3) % 4]};
            if (!is_outer(face[0]) || !is_outer(face[1]) || !is_outer(face[2])) continue;
            const Vec3& corner = mesh.nodes[face[0]];
            Vec3 area = 0.5 * (mesh.nodes[face[1]] - corner).cross(mesh.nodes[face[2]] - corner);
            if (area.dot(corner) < 0) area = -area;
            for (const Index n : face)
                forces.block<3, 1>(3 * n, 0) -= options.pressure_kpa / 3 * area;
        }
    for (Index d = 0; d < model.num_dofs(); ++d)
        if (model.prescribed[d]) forces(d, 0) = 0;
    return forces;
}

}  // namespace

double sphere_displacement_mm(const SpheresOptions& options, double r) {
    const Vec3 c = lame_coefficients(options);
    return r <= options.inner_radius_mm ? c[0] * r : c[1] * r + c[2] / (r * r);
}

double pressed_inner_radius_mm(const SpheresOptions& options) {
    return options.inner_radius_mm + sphere_displacement_mm(options, options.inner_radius_mm);
}

Model spheres_model(const SpheresOptions& options, Index layers) {
    if (layers < 5 || layers % 5 != 0) {
        throw Error(ErrorCode::invalid_argument,
                    "The spheres need a multiple of 5 layers, not " + std::to_string(layers) + ".");
    }
    Model model;
    model.mesh = OctantBuilder(options, layers).build();
    model.materials = {options.inner, options.outer};
    model.prescribed.assign(3 * model.mesh.nodes.size(), 0);
    for (Index n = 0; n < model.mesh.num_nodes(); ++n)
        for (int c = 0; c < 3; ++c)
            if (model.mesh.nodes[n][c] == 0) model.prescribed[3 * n + c] = 1;
    return model;
}

double solved_inner_radius_mm(const SpheresOptions& options, Index layers,
                              const LinearSolverOptions& solver) {
    const Model model = spheres_model(options, layers);
    Columns u;
    const auto summary =
        make_linear_solver(model, solver)->solve(pressure_forces(model, options), u);
    if (!summary.converged)
        throw Error(ErrorCode::solve_failed, "The spheres could not be solved: " + summary.message);
    double sum = 0;
    Index count = 0;
    for (Index n = 0; n < model.mesh.num_nodes(); ++n) {
        const Vec3& x = model.mesh.nodes[n];
        if (std::abs(x.norm() - options.inner_radius_mm) > 1e-9) continue;
        sum += (x + u.block<3, 1>(3 * n, 0)).norm();
        ++count;
    }
    return sum / count;
}

}  // namespace palpate
