// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host/inverse/reduced_model.hpp"
#include "host/inverse/wall_prior.hpp"

namespace palpate {

struct ResponseOptions {
    /// Root mean square of the observed displacement that may be left out, mm, for wall motions
    /// drawn from the prior at any of the tested moduli. Far below a voxel's noise; raise it to
    /// save time on very large surfaces.
    double tolerance_mm = 0.05;
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
class ResponseModel {
public:
    struct Region {
        Index region = 0;
        Eigen::MatrixXd stiffness;  ///< S_r [modes, modes] mN/mm per kPa
        Eigen::MatrixXd coupling;   ///< T_r [modes, functionals]; empty without driven nodes
    };

    /// Nothing left out: every observed degree of freedom is a mode, every driven one a functional.
    static ResponseModel exact(const ReducedModel& model, const WallPrior& prior);
    /// `unknown`: regions whose moduli will change.
    static ResponseModel compressed(const ReducedModel& model, const WallPrior& prior,
                                    const std::vector<Index>& unknown,
                                    const ResponseOptions& options);

    Index num_modes() const { return static_cast<Index>(modes_.cols()); }
    Index num_functionals() const { return static_cast<Index>(functionals_.rows()); }
    Index driven_dofs() const { return static_cast<Index>(functionals_.cols()); }
    Index observed_dofs() const { return static_cast<Index>(modes_.rows()); }
    const std::vector<Region>& regions() const { return regions_; }
    const std::vector<double>& stiffness_kpa() const { return stiffness_kpa_; }
    const Eigen::MatrixXd& modes() const { return modes_; }              ///< V
    const Eigen::MatrixXd& functionals() const { return functionals_; }  ///< N
    const Eigen::MatrixXd& spread() const { return spread_; }  ///< Q^-1 N^T [driven_dofs, k]
    const Eigen::MatrixXd& prior_covariance() const { return prior_covariance_; }  ///< N Q^-1 N^T
    /// P [functionals, rank] with P P^T = `covariance` of the functionals, up to motions that move
    /// the observed surface by less than the tolerance.
    Eigen::MatrixXd significant_root(const Eigen::MatrixXd& covariance) const;
    /// Measured: root mean square of the observed displacement left out, mm.
    double left_out_mm() const { return left_out_mm_; }

    /// The moduli of all regions [num regions] with those of `regions` replaced.
    std::vector<double> moduli(const std::vector<Index>& regions,
                               const Eigen::VectorXd& theta) const;
    Eigen::MatrixXd stiffness(const std::vector<double>& kpa) const;
    Eigen::MatrixXd coupling(const std::vector<double>& kpa) const;
    /// u_o [observed_dofs] for a wall motion, mm.
    Eigen::VectorXd observed_displacement(const std::vector<double>& kpa,
                                          const Eigen::VectorXd& driven) const;

private:
    friend class ResponseBuilder;
    std::vector<Region> regions_;
    std::vector<double> stiffness_kpa_;
    Eigen::MatrixXd modes_, functionals_, spread_, prior_covariance_;
    Eigen::VectorXd influence_;  ///< norm of the observed displacement for each unit functional, mm
    double root_tolerance_ = 0;
    double left_out_mm_ = 0;
};

}  // namespace palpate
