// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "host/apps/recover/inverse/mode_stiffness.hpp"
#include "host/apps/recover/inverse/reduced_model.hpp"
#include "host/apps/recover/inverse/wall_prior.hpp"
#include "solver/base/log.hpp"

namespace palpate {

/// The displacement at which mechanics were linearised. Empty: at rest.
struct LinearisationPoint {
    Eigen::VectorXd driven;    ///< u_d* [driven_dofs] mm
    Eigen::VectorXd observed;  ///< u_o* [observed_dofs] mm
    bool is_rest() const { return observed.size() == 0; }
};

struct ResponseOptions {
    /// Root mean square of the observed displacement that may be left out, mm, for wall motions
    /// drawn from the prior at any of the tested moduli. Far below a voxel's noise; raise it to
    /// save time on very large surfaces.
    double tolerance_mm = 0.02;
    double softest_kpa = 3, stiffest_kpa = 3000;  ///< range of the unknown moduli to be exact in
    unsigned seed = 1;
};

/// The condensed model as the search sees it: u_o = -V S(E)^-1 T(E) c, c = N u_d, with
///   S(E) = sum_r E_r S_r [modes, modes],  T(E) = sum_r E_r T_r [modes, functionals].
/// The map from driven to observed motion is smoothing: of thousands of driven components only a
/// few hundred functionals N u_d matter, and the answers to them span a few hundred modes V. Both
/// are found from responses at a few moduli (randomised range finder, Halko, Martinsson and Tropp
/// 2011, section 4; reduced basis with greedy enrichment, Hesthaven, Rozza and Stamm 2016, chapter
/// 3); between those moduli the Galerkin solution in V interpolates. What is left out is measured
/// against the condensed model. Functionals are scaled to unit prior variance: N Q^-1 N^T = 1.
/// Of mechanics that were linearised at (u_d*, u_o*) (tangent_response.hpp) it is
///   u_o = u_o* - V S(E)^-1 (T(E) c + g(E)),  c = N (u_d - u_d*).
/// With one unknown modulus E_u the modes are those in which S is diagonal whatever it is: the
/// solutions of S_u v = lambda S(E*) v at one E_u*, so that S = 1 + (E_u - E_u*) diag(lambda).
class ResponseModel {
public:
    struct Region {
        Index region = 0;
        Eigen::MatrixXd stiffness;   ///< S_r [modes, modes] mN/mm per kPa
        Eigen::MatrixXd coupling;    ///< T_r [modes, functionals]; empty without driven nodes
        Eigen::VectorXd force = {};  ///< g_r [modes] mN per kPa; empty at rest
    };

    /// All that a response model consists of: what is saved and read back.
    struct Parts {
        std::vector<Region> regions;
        std::vector<double> stiffness_kpa;  ///< [num regions] of the model that was condensed
        Eigen::MatrixXd modes, functionals, spread, prior_covariance;  ///< see below
        Eigen::VectorXd influence;  ///< norm of the observed motion per unit functional, mm
        double root_tolerance = 0;
        double left_out_mm = 0;
        LinearisationPoint point = {};
    };

    /// Throws Error(invalid_argument) if the parts do not fit together.
    explicit ResponseModel(Parts parts);
    /// In modes in which the stiffness of `region` and of all together at the moduli `kpa` are
    /// diagonal; as it was where there are none.
    static ResponseModel diagonal_in(Index region, const std::vector<double>& kpa, Parts parts);
    /// Nothing left out: every observed degree of freedom is a mode, every driven one a functional.
    static ResponseModel exact(const ReducedModel& model, const WallPrior& prior);
    /// `unknown`: regions whose moduli will change. `progress` is only asked whether to cancel.
    static ResponseModel compressed(const ReducedModel& model, const WallPrior& prior,
                                    const std::vector<Index>& unknown,
                                    const ResponseOptions& options,
                                    const ProgressSink& progress = {});

    /// The same answers with other expectations of the walls: Q^-1 N^T and N Q^-1 N^T are the
    /// prior's.
    ResponseModel with_walls(const WallPrior& prior) const;

    /// The same answers moved by `observed` [observed_dofs] mm, whatever the motion.
    ResponseModel shifted_by(const Eigen::VectorXd& observed) const;

    Index num_modes() const { return static_cast<Index>(parts_.modes.cols()); }
    Index num_functionals() const { return static_cast<Index>(parts_.functionals.rows()); }
    Index driven_dofs() const { return static_cast<Index>(parts_.functionals.cols()); }
    Index observed_dofs() const { return static_cast<Index>(parts_.modes.rows()); }
    const std::vector<Region>& regions() const { return parts_.regions; }
    const std::vector<double>& stiffness_kpa() const { return parts_.stiffness_kpa; }
    const Eigen::MatrixXd& modes() const { return parts_.modes; }              ///< V
    const Eigen::MatrixXd& functionals() const { return parts_.functionals; }  ///< N
    const Eigen::MatrixXd& spread() const { return parts_.spread; }  ///< Q^-1 N^T [driven_dofs, k]
    const Eigen::MatrixXd& prior_covariance() const {
        return parts_.prior_covariance;
    }  ///< N Q^-1 N^T
    /// P [functionals, rank] with P P^T = `covariance` of the functionals, up to motions that move
    /// the observed surface by less than the tolerance.
    Eigen::MatrixXd significant_root(const Eigen::MatrixXd& covariance) const;
    /// Measured: root mean square of the observed displacement left out, mm.
    double left_out_mm() const { return parts_.left_out_mm; }

    /// The moduli of all regions [num regions] with those of `regions` replaced.
    std::vector<double> moduli(const std::vector<Index>& regions,
                               const Eigen::VectorXd& theta) const;
    Eigen::MatrixXd stiffness(const std::vector<double>& kpa) const;
    /// S(E), factorised. Throws Error(solve_failed) where it is not positive definite.
    ModeStiffness factorised_stiffness(const std::vector<double>& kpa) const;
    /// Whether S(E) is positive definite.
    bool is_stable(const std::vector<double>& kpa) const;
    /// Whether S_r of this region is diagonal, as is S(E) where no other modulus changes.
    bool is_diagonal_in(Index region) const {
        return diagonal_ && parts_.regions[diagonal_->part].region == region;
    }
    Eigen::MatrixXd coupling(const std::vector<double>& kpa) const;
    const LinearisationPoint& point() const { return parts_.point; }
    /// c [functionals] of a wall motion u_d [driven_dofs] mm.
    Eigen::VectorXd motion_of(const Eigen::VectorXd& driven) const;
    /// What moduli make of S c = f: S factorised, for any number of motions.
    struct Equilibrium {
        ModeStiffness stiffness;
        Eigen::MatrixXd coupling;
        Eigen::VectorXd force;
    };
    Equilibrium equilibrium_at(const std::vector<double>& kpa) const;
    /// u_o [observed_dofs] for a wall motion, mm.
    Eigen::VectorXd observed_displacement(const Equilibrium& equilibrium,
                                          const Eigen::VectorXd& driven) const;
    Eigen::VectorXd observed_displacement(const std::vector<double>& kpa,
                                          const Eigen::VectorXd& driven) const {
        return observed_displacement(equilibrium_at(kpa), driven);
    }

    const Parts& parts() const { return parts_; }

private:
    friend class ResponseBuilder;
    /// S = diag(rest + E of_part), the moduli of all other regions as they were when it was found.
    struct Diagonal {
        std::size_t part = 0;  ///< in `regions`
        Eigen::VectorXd of_part, rest;
        std::vector<double> kpa;
    };

    ResponseModel() = default;
    void find_diagonal();
    /// The moduli of `diagonal_`?
    bool is_diagonal_at(const std::vector<double>& kpa) const;
    ModeStiffness factor_of(const std::vector<double>& kpa) const;

    Parts parts_;
    std::optional<Diagonal> diagonal_;
};

}  // namespace palpate
