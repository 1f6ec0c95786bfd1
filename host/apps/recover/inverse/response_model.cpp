// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/response_model.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/estimate/column_basis.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

bool has_size(const Eigen::MatrixXd& matrix, Eigen::Index rows, Eigen::Index columns) {
    return matrix.rows() == rows && matrix.cols() == columns;
}

bool fit_together(const ResponseModel::Parts& parts) {
    const Eigen::Index modes = parts.modes.cols(), functionals = parts.functionals.rows();
    const Index num_regions = static_cast<Index>(parts.stiffness_kpa.size());
    return has_size(parts.spread, parts.functionals.cols(), functionals) &&
           has_size(parts.prior_covariance, functionals, functionals) &&
           parts.influence.size() == functionals &&
           (parts.point.is_rest() || (parts.point.driven.size() == parts.functionals.cols() &&
                                      parts.point.observed.size() == parts.modes.rows())) &&
           std::all_of(parts.regions.begin(), parts.regions.end(), [&](const auto& part) {
               return part.region >= 0 && part.region < num_regions &&
                      has_size(part.stiffness, modes, modes) &&
                      (part.force.size() == 0 || part.force.size() == modes) &&
                      (part.coupling.size() == 0 || has_size(part.coupling, modes, functionals));
           });
}

}  // namespace

ResponseModel::ResponseModel(Parts parts) : parts_(std::move(parts)) {
    if (!fit_together(parts_)) {
        throw Error(ErrorCode::invalid_argument, "the parts of a response model do not fit");
    }
    find_diagonal();
}

std::vector<double> ResponseModel::moduli(const std::vector<Index>& regions,
                                          const Eigen::VectorXd& theta) const {
    std::vector<double> kpa = parts_.stiffness_kpa;
    for (std::size_t k = 0; k < regions.size(); ++k) {
        kpa[regions[k]] = std::exp(theta[static_cast<Index>(k)]);
    }
    return kpa;
}

Eigen::MatrixXd ResponseModel::stiffness(const std::vector<double>& kpa) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(num_modes(), num_modes());
    // S(E) = sum_r E_r V^T S_r V (method.md, 1.3)
    for (const Region& part : parts_.regions) sum += kpa[part.region] * part.stiffness;
    return sum;
}

/// Whether what is off the diagonal is rounding.
void ResponseModel::find_diagonal() {
    constexpr double rounding = 1e-8;
    diagonal_.reset();
    for (std::size_t r = 0; r < parts_.regions.size() && !diagonal_; ++r) {
        const Eigen::MatrixXd& own = parts_.regions[r].stiffness;
        if (own.size() == 0 || !own.isDiagonal(0)) continue;
        std::vector<double> kpa = parts_.stiffness_kpa;
        kpa[parts_.regions[r].region] = 0;
        const Eigen::MatrixXd rest = stiffness(kpa);
        // S(E) = rest + E diag: in these modes each E costs a division and no factor.
        if (rest.isDiagonal(rounding)) diagonal_ = {r, own.diagonal(), rest.diagonal(), kpa};
    }
}

bool ResponseModel::is_diagonal_at(const std::vector<double>& kpa) const {
    if (!diagonal_) return false;
    std::vector<double> others = kpa;
    others[parts_.regions[diagonal_->part].region] = 0;
    return others == diagonal_->kpa;
}

ModeStiffness ResponseModel::factor_of(const std::vector<double>& kpa) const {
    if (!is_diagonal_at(kpa)) return ModeStiffness(stiffness(kpa));
    const double own = kpa[parts_.regions[diagonal_->part].region];
    return ModeStiffness(Eigen::VectorXd(diagonal_->rest + own * diagonal_->of_part));
}

ModeStiffness ResponseModel::factorised_stiffness(const std::vector<double>& kpa) const {
    ModeStiffness factor = factor_of(kpa);
    if (!factor.is_definite()) throw_indefinite("stiffness of the observed nodes", num_modes());
    return factor;
}

bool ResponseModel::is_stable(const std::vector<double>& kpa) const {
    return factor_of(kpa).is_definite();
}

Eigen::MatrixXd ResponseModel::coupling(const std::vector<double>& kpa) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(num_modes(), num_functionals());
    for (const Region& part : parts_.regions) {
        // T(E) = sum_r E_r V^T S_r,od Q^-1 N^T
        if (part.coupling.size() > 0) sum += kpa[part.region] * part.coupling;
    }
    return sum;
}

Eigen::VectorXd ResponseModel::motion_of(const Eigen::VectorXd& driven) const {
    if (parts_.functionals.rows() == 0) return {};  // BLAS takes no empty matrices
    if (parts_.point.is_rest()) return parts_.functionals * driven;
    return parts_.functionals * (driven - parts_.point.driven);
}

ResponseModel::Equilibrium ResponseModel::equilibrium_at(const std::vector<double>& kpa) const {
    if (num_modes() == 0) return {};
    Equilibrium equilibrium{factorised_stiffness(kpa), coupling(kpa),
                            Eigen::VectorXd::Zero(num_modes())};
    for (const Region& part : parts_.regions)
        if (part.force.size() > 0) equilibrium.force += kpa[part.region] * part.force;
    return equilibrium;
}

Eigen::VectorXd ResponseModel::observed_displacement(const Equilibrium& equilibrium,
                                                     const Eigen::VectorXd& driven) const {
    if (num_modes() == 0) return Eigen::VectorXd::Zero(observed_dofs());
    // u_o = u_o* - V S^-1 (T c + g),  c = N (u_d - u_d*) (method.md, 1.4 and 10.2)
    const Eigen::VectorXd force = equilibrium.coupling * motion_of(driven) + equilibrium.force;
    const Eigen::VectorXd change = -(parts_.modes * equilibrium.stiffness.solve(force));
    return parts_.point.is_rest() ? change : Eigen::VectorXd(parts_.point.observed + change);
}

Eigen::MatrixXd ResponseModel::significant_root(const Eigen::MatrixXd& covariance) const {
    const Eigen::MatrixXd weighted =
        parts_.influence.asDiagonal() * covariance * parts_.influence.asDiagonal();
    // W C W ~ R R^T by pivoted Cholesky, W what a functional moves on the observed surface; W^-1 R
    const ColumnSelection kept = select_columns(weighted, parts_.root_tolerance);
    return parts_.influence.cwiseInverse().asDiagonal() * kept.root;
}

ResponseModel ResponseModel::diagonal_in(Index region, const std::vector<double>& kpa,
                                         Parts parts) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(parts.modes.cols(), parts.modes.cols());
    Region* own = nullptr;
    for (Region& part : parts.regions) {
        all += kpa[part.region] * part.stiffness;
        if (part.region == region) own = &part;
    }
    if (!own || all.size() == 0) return ResponseModel(std::move(parts));
    // S_u V = S(E) V diag(lambda), V^T S(E) V = 1
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(own->stiffness, all);
    if (eigen.info() != Eigen::Success) return ResponseModel(std::move(parts));
    const Eigen::MatrixXd& turned = eigen.eigenvectors();
    parts.modes = (parts.modes * turned).eval();
    for (Region& part : parts.regions) {
        if (part.force.size() > 0) part.force = (turned.transpose() * part.force).eval();
        if (part.coupling.size() > 0) part.coupling = (turned.transpose() * part.coupling).eval();
        if (&part == own) continue;
        part.stiffness = (turned.transpose() * part.stiffness * turned).eval();
    }
    own->stiffness = eigen.eigenvalues().asDiagonal();
    return ResponseModel(std::move(parts));
}

/// Finds functionals and modes from responses of the condensed model at a few moduli.
class ResponseBuilder {
public:
    ResponseBuilder(const ReducedModel& model, const WallPrior& prior,
                    const std::vector<Index>& unknown, const ResponseOptions& options,
                    const ProgressSink& progress)
        : model_(model), prior_(prior), unknown_(unknown), options_(options), progress_(progress) {
        parts_.stiffness_kpa = model.stiffness_kpa();
    }

    ResponseModel exact() {
        const Index n = model_.driven_dofs();
        parts_.modes.setIdentity(model_.observed_dofs(), model_.observed_dofs());
        // Without observed nodes nothing that is seen depends on the functionals.
        parts_.functionals.setIdentity(model_.observed_dofs() == 0 ? 0 : n, n);
        parts_.spread = prior_.covariance_times(parts_.functionals.transpose());
        parts_.prior_covariance = parts_.functionals * parts_.spread;
        parts_.influence.setOnes(parts_.functionals.rows());
        for (const auto& region : model_.regions()) {
            parts_.regions.push_back(
                {region.region, model_.unit_stiffness_times(region, parts_.modes),
                 model_.unit_coupling_times(region, parts_.functionals.transpose())});
        }
        return std::move(result_);
    }

    ResponseModel compressed() {
        find_functionals();
        for (const auto& region : model_.regions()) {
            if (region.driven.empty()) {
                couplings_.emplace_back();
            } else {
                check_cancelled(progress_);
                couplings_.push_back(model_.unit_coupling_times(region, parts_.spread));
            }
        }
        for (const double t : {0.0, 1.0, 0.5}) add_modes_at(moduli_at(t));
        if (unknown_.size() > 1) {
            for (const Index region : unknown_) add_modes_off_the_diagonal(region);
        }
        project();
        test();
        if (unknown_.size() == 1)
            return ResponseModel::diagonal_in(unknown_[0], moduli_at(0.5), std::move(parts_));
        result_.find_diagonal();
        return std::move(result_);
    }

private:
    using Moduli = std::vector<double>;

    /// All unknown moduli together, from the softest (t = 0) to the stiffest (t = 1).
    Moduli moduli_at(double t) const {
        Moduli kpa = model_.stiffness_kpa();
        // softest (stiffest / softest)^t: even steps of ln E
        for (const Index region : unknown_)
            kpa[region] =
                options_.softest_kpa * std::pow(options_.stiffest_kpa / options_.softest_kpa, t);
        return kpa;
    }

    Eigen::LLT<Eigen::MatrixXd> equilibrium_at(const Moduli& kpa) const {
        check_cancelled(progress_);
        return cholesky(model_.stiffness(kpa), "stiffness of the observed nodes");
    }

    double tolerance() const {
        // A norm over all observed dofs for a root mean square over nodes.
        return options_.tolerance_mm * std::sqrt(std::max(1.0, model_.observed_dofs() / 3.0));
    }

    /// Functionals that carry all but the tolerance of the response to random wall motions. The
    /// softest tissue follows the finest motions.
    void find_functionals() {
        const bool driven_modulus_changes =
            std::any_of(model_.regions().begin(), model_.regions().end(), [&](const auto& region) {
                return !region.driven.empty() &&
                       std::find(unknown_.begin(), unknown_.end(), region.region) != unknown_.end();
            });
        std::vector<double> where{0.0};
        if (driven_modulus_changes) where = {0.0, 0.5, 1.0};
        Eigen::MatrixXd stacked(0, model_.driven_dofs());
        for (const double t : where) {
            const Eigen::MatrixXd part = functionals_at(moduli_at(t));
            Eigen::MatrixXd more(stacked.rows() + part.rows(), stacked.cols());
            more << stacked, part;
            stacked = std::move(more);
        }
        check_cancelled(progress_);
        const Eigen::MatrixXd spread = prior_.covariance_times(stacked.transpose());
        check_cancelled(progress_);
        // A subset N of the stacked functionals, turned such that N Q^-1 N^T = 1: c ~ N(0, 1).
        const ColumnSelection kept = select_columns(stacked * spread, 0.1 * tolerance());
        parts_.functionals = kept.rows_of(stacked);
        parts_.spread = kept.columns_of(spread);
        parts_.prior_covariance =
            Eigen::MatrixXd::Identity(parts_.functionals.rows(), parts_.functionals.rows());
    }

    /// Q^T A of the response A = S_oo^-1 S_od, Q an orthonormal basis of its range.
    Eigen::MatrixXd functionals_at(const Moduli& kpa) const {
        const auto equilibrium = equilibrium_at(kpa);
        const Index most = std::min(model_.driven_dofs(), model_.observed_dofs());
        Eigen::MatrixXd basis;
        for (Index count = std::min<Index>(most, 720);; count = std::min<Index>(most, 2 * count)) {
            check_cancelled(progress_);
            const Eigen::MatrixXd forces =
                model_.coupling_times(kpa, prior_.samples(count, options_.seed));
            check_cancelled(progress_);
            // A Omega, Omega drawn from the prior: its columns span the range of A that walls
            // excite
            // (randomised range finder, Halko, Martinsson and Tropp 2011, algorithm 4.1).
            const Eigen::MatrixXd responses = equilibrium.solve(forces);
            check_cancelled(progress_);
            basis = orthonormal_columns(responses, 0.5 * tolerance() * std::sqrt(count));
            if (basis.cols() < count - 16 || count == most) break;
        }
        check_cancelled(progress_);
        return model_.transposed_coupling_times(kpa, equilibrium.solve(basis)).transpose();
    }

    /// Responses to the functionals' unit motions at `kpa` [observed_dofs, functionals].
    Eigen::MatrixXd responses_at(const Moduli& kpa) const {
        Eigen::MatrixXd force =
            Eigen::MatrixXd::Zero(model_.observed_dofs(), parts_.functionals.rows());
        for (std::size_t r = 0; r < couplings_.size(); ++r) {
            // S(E) x = T(E) c, for the modes to span (method.md, 1.4)
            if (couplings_[r].size() > 0) force += kpa[model_.regions()[r].region] * couplings_[r];
        }
        const auto equilibrium = equilibrium_at(kpa);
        check_cancelled(progress_);
        return equilibrium.solve(force);
    }

    void add_modes_at(const Moduli& kpa) {
        const Eigen::MatrixXd responses = responses_at(kpa);
        check_cancelled(progress_);
        if (parts_.influence.size() == 0) {
            const double floor = 1e-6 * responses.norm();
            parts_.influence = responses.colwise().norm().cwiseMax(floor).transpose();
            parts_.root_tolerance = 0.5 * tolerance();
        }
        // V <- [V, what of the responses V does not span]
        parts_.modes = extended_basis(parts_.modes, responses, 0.5 * tolerance());
    }

    void add_modes_off_the_diagonal(Index region) {
        for (const double t : {0.15, 0.85}) {
            Moduli kpa = moduli_at(0.5);
            kpa[region] = moduli_at(t)[region];
            add_modes_at(kpa);
        }
    }

    void project() {
        parts_.regions.clear();
        const Eigen::MatrixXd& modes = parts_.modes;
        for (std::size_t r = 0; r < couplings_.size(); ++r) {
            check_cancelled(progress_);
            const auto& region = model_.regions()[r];
            const Eigen::MatrixXd stiffness =
                // Galerkin: V^T S_r V, V^T T_r
                modes.transpose() * model_.unit_stiffness_times(region, modes);
            ResponseModel::Region part{
                region.region, 0.5 * (stiffness + stiffness.transpose()), {}};
            if (couplings_[r].size() > 0) part.coupling = modes.transpose() * couplings_[r];
            parts_.regions.push_back(std::move(part));
        }
    }

    /// Measures what is left out between the moduli used so far, for fresh wall motions, and adds
    /// modes there while it is too much.
    void test() {
        const Eigen::MatrixXd walls = prior_.samples(4, options_.seed + 1000);
        for (const double t : {0.25, 0.75}) {
            // Greedy enrichment: modes are added where the reduced basis is worst.
            double left_out = left_out_at(moduli_at(t), walls);
            if (left_out > options_.tolerance_mm) {
                add_modes_at(moduli_at(t));
                project();
                left_out = left_out_at(moduli_at(t), walls);
            }
            parts_.left_out_mm = std::max(parts_.left_out_mm, left_out);
        }
    }

    double left_out_at(const Moduli& kpa, const Eigen::MatrixXd& walls) const {
        // u_o of the condensed model against that of the response model, root mean square over
        // nodes
        const Eigen::MatrixXd exact = -equilibrium_at(kpa).solve(model_.coupling_times(kpa, walls));
        double sum = 0;
        for (Index k = 0; k < walls.cols(); ++k)
            sum += (exact.col(k) - result_.observed_displacement(kpa, walls.col(k))).squaredNorm();
        return std::sqrt(sum / (walls.cols() * std::max(1.0, exact.rows() / 3.0)));
    }

    const ReducedModel& model_;
    const WallPrior& prior_;
    const std::vector<Index>& unknown_;
    const ResponseOptions& options_;
    const ProgressSink& progress_;
    ResponseModel result_;
    ResponseModel::Parts& parts_ = result_.parts_;
    std::vector<Eigen::MatrixXd> couplings_;  ///< S_r,od Q^-1 N^T per region
};

ResponseModel ResponseModel::with_walls(const WallPrior& prior) const {
    ResponseModel other = *this;
    other.parts_.spread = prior.covariance_times(parts_.functionals.transpose());
    other.parts_.prior_covariance = parts_.functionals * other.parts_.spread;
    return other;
}

ResponseModel ResponseModel::shifted_by(const Eigen::VectorXd& observed) const {
    ResponseModel other = *this;
    LinearisationPoint& point = other.parts_.point;
    if (point.is_rest()) {
        point.driven.setZero(driven_dofs());
        point.observed = observed;
    } else {
        point.observed += observed;
    }
    return other;
}

ResponseModel ResponseModel::exact(const ReducedModel& model, const WallPrior& prior) {
    return ResponseBuilder(model, prior, {}, {}, {}).exact();
}

ResponseModel ResponseModel::compressed(const ReducedModel& model, const WallPrior& prior,
                                        const std::vector<Index>& unknown,
                                        const ResponseOptions& options,
                                        const ProgressSink& progress) {
    if (model.observed_dofs() == 0 || model.driven_dofs() == 0) return exact(model, prior);
    return ResponseBuilder(model, prior, unknown, options, progress).compressed();
}

}  // namespace palpate
