// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/linearised_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/apps/recover/inverse/slice_share.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

std::vector<Index> regions_of(const std::vector<Unknown>& unknowns) {
    std::vector<Index> regions;
    for (const Unknown& unknown : unknowns) regions.push_back(unknown.object);
    return regions;
}

/// D, what each row counts where the size of the noise is found.
Eigen::VectorXd weights_of(const std::vector<LinearRow>& rows) {
    Eigen::VectorXd weights(rows.size());
    std::transform(rows.begin(), rows.end(), weights.begin(),
                   [](const LinearRow& row) { return row.weight; });
    return weights;
}

}  // namespace

// The wall motion that is left free by the walls' own data, c = N m + P w with w ~ N(0, 1): all
// products are made with P, whose rank is below the number of functionals. The rows enter through
//   I = V^T G_o^T R^-1 G_o V:   B = -R^-1/2 G_o V X = R^-1/2 J P,   B^T B = X^T I X.
struct LinearisedProblem::Response {
    std::vector<double> kpa;    // by region
    ModeStiffness equilibrium;  // S(E)
    // [X | s] = S^-1 T [P | N m], below it the frame's part, [modes + 6, rank + 1]
    Eigen::MatrixXd shapes;
    Eigen::MatrixXd informed;           // I [X | s]
    Eigen::LLT<Eigen::MatrixXd> inner;  // of M = 1 + B^T B
    // With all rows whitened by R^-1/2, C^-1 = 1 - B M^-1 B^T, and M has the rank of the free wall
    // motion (Woodbury); e = y + G_o V s, alpha = C^-1 e = e - B w.
    Eigen::VectorXd motion;  // w = M^-1 B^T e = B^T alpha
    Eigen::VectorXd pull;    // V^T G_o^T alpha
    double misfit = 0;       // e^T alpha
};

LinearisedProblem::LinearisedProblem(const ResponseModel& model, const WallPrior& prior,
                                     const std::vector<LinearRow>& rows,
                                     const Eigen::VectorXd& driven, const Eigen::VectorXd& observed,
                                     const std::vector<Unknown>& unknowns, const FramePrior& frame)
    : model_(model),
      prior_(prior),
      frame_(frame),
      walls_(prior, rows, driven, frame),
      unknowns_(unknowns),
      unknown_(regions_of(unknowns)) {
    read_rows(rows, observed);
    mean_ = model.motion_of(walls_.mean());
    spread_root_ = spread_of_motions();
    frame_shapes_.setZero(frame_.size(), rank() + 1);
    frame_shapes_.block(0, rank() - frame_.size(), frame_.size(), frame_.size()) =
        -walls_.frame_root();
    frame_shapes_.col(rank()) = -walls_.frame_mean().head(frame_.size());
    Eigen::MatrixXd motions(mean_.size(), rank() + 1);
    motions.leftCols(rank()) = spread_root_;
    motions.col(rank()) = mean_;
    for (const auto& region : model.regions()) {
        coupling_.emplace_back();
        if (region.coupling.size() > 0) coupling_.back() = region.coupling * motions;
        if (region.force.size() == 0) continue;
        if (coupling_.back().size() == 0) {
            coupling_.back().setZero(model.num_modes(), motions.cols());
        }
        // T_r c + g_r: what does not balance at the last state moves with the mean (method.md,
        // 10.2).
        coupling_.back().col(rank()) += region.force;
    }
}

/// [P | -N D L]: the walls' free motion, then what it takes to go with each of the frame's.
Eigen::MatrixXd LinearisedProblem::spread_of_motions() const {
    const Eigen::MatrixXd free =
        model_.significant_root(walls_.covariance_of(model_.spread(), model_.prior_covariance()));
    if (frame_.size() == 0) return free;
    Eigen::MatrixXd root(free.rows(), free.cols() + 6);
    root << free, -(model_.functionals() * (walls_.frame_spread() * walls_.frame_root()));
    return root;
}

void LinearisedProblem::read_rows(const std::vector<LinearRow>& rows,
                                  const Eigen::VectorXd& observed) {
    for (const auto& row : rows) {
        if (!row.on_driven) observed_.rows.push_back(row);
    }
    const Index num_rows = num_observed_rows();
    const LinearisationPoint& point = model_.point();
    const Eigen::VectorXd change =
        point.is_rest() ? observed : Eigen::VectorXd(observed - point.observed);
    const Index num_modes = model_.num_modes() + frame_.size();
    observed_.along_modes.resize(num_rows, num_modes);
    observed_.target.resize(num_rows);
    const Eigen::MatrixXd noise = noise_matrix(observed_.rows);
    const Eigen::VectorXd weights = weights_of(observed_.rows);
    for (Index c = 0; c < model_.num_modes(); ++c) {
        const double* mode = model_.modes().col(c).data();
        for (Index j = 0; j < num_rows; ++j) {
            const LinearRow& row = observed_.rows[j];
            observed_.along_modes(j, c) =
                row.normal.dot(Eigen::Map<const Vec3>(mode + 3 * row.position));
        }
    }
    for (Index j = 0; j < num_rows; ++j) {
        const LinearRow& row = observed_.rows[j];
        const FrameMotion turned = frame_.frame.row(row.place, row.normal);
        observed_.along_modes.row(j).tail(frame_.size()) = turned.head(frame_.size());
        // y_j = n . u_o + (the frame's part) - r_j: the row's value at which its distance is zero
        observed_.target[j] = row.normal.dot(change.segment<3>(3 * row.position)) +
                              turned.dot(frame_.motion) - row.residual_mm;
    }
    Eigen::MatrixXd seen_modes = observed_.along_modes;
    Eigen::VectorXd target = observed_.target;
    noise_trace_ = weights.dot(noise.diagonal());  // tr D R
    // R = L L^T: L^-1 G V and L^-1 y turn R^-1 into plain products.
    const auto noise_factor = cholesky(noise, "covariance of the noise");
    noise_factor.matrixL().solveInPlace(seen_modes);
    noise_factor.matrixL().solveInPlace(target);
    noise_log_determinant_ = 2.0 * noise_factor.matrixLLT().diagonal().array().log().sum();
    information_.setZero(num_modes, num_modes);
    pull_of_target_.setZero(num_modes);
    target_misfit_ = target.squaredNorm();
    if (num_rows == 0 || num_modes == 0) return;  // BLAS takes no empty matrices
    information_.selfadjointView<Eigen::Lower>().rankUpdate(seen_modes.transpose());
    information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
    pull_of_target_ = seen_modes.transpose() * target;
}

LinearisedProblem::Response LinearisedProblem::respond(const Eigen::VectorXd& theta) const {
    Response response;
    response.kpa = model_.moduli(unknown_, theta);
    response.equilibrium = model_.factorised_stiffness(response.kpa);
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(model_.num_modes(), rank() + 1);
    for (std::size_t r = 0; r < coupling_.size(); ++r) {
        if (coupling_[r].size() == 0) continue;
        // X = S(E)^-1 T(E) P and s = S^-1 T N m in one solve, S and T = sum E_r (S_r, T_r)
        forces += response.kpa[model_.regions()[r].region] * coupling_[r];
    }
    response.equilibrium.solve_in_place(forces);
    response.shapes.resize(forces.rows() + frame_.size(), forces.cols());
    response.shapes << forces, frame_shapes_;
    response.informed = information_ * response.shapes;
    Eigen::MatrixXd inner(rank(), rank());
    // M = 1 + B^T B = 1 + X^T I X
    inner.triangularView<Eigen::Lower>() =
        response.shapes.leftCols(rank()).transpose() * response.informed.leftCols(rank());
    inner.diagonal().array() += 1.0;
    response.inner = cholesky(inner, "covariance of the observed surface");

    const auto mean_shape = response.shapes.col(rank());
    // V^T G^T R^-1 e with e = y + G V s, then w = M^-1 B^T e and e^T C^-1 e = e^T e - w^T B^T e
    const Eigen::VectorXd pull_of_error = pull_of_target_ + response.informed.col(rank());
    const Eigen::VectorXd seen_error =  // B^T e
        -(response.shapes.leftCols(rank()).transpose() * pull_of_error);
    response.motion = response.inner.solve(seen_error);
    response.pull = pull_of_error + response.informed.leftCols(rank()) * response.motion;
    response.misfit = target_misfit_ + mean_shape.dot(pull_of_target_ + pull_of_error) -
                      response.motion.dot(seen_error);
    return response;
}

/// Tissue at rest is, whatever its moduli.
bool LinearisedProblem::is_stable(const Eigen::VectorXd& theta) const {
    if (model_.point().is_rest()) return true;
    return model_.is_stable(model_.moduli(unknown_, theta));
}

LinearisedProblem::Evaluation LinearisedProblem::evaluate(const Eigen::VectorXd& theta,
                                                          bool with_gradient) const {
    Evaluation result;
    result.gradient = Eigen::VectorXd::Zero(num_unknown());
    result.objective = prior_energy(unknowns_, theta);
    for (Index k = 0; k < num_unknown(); ++k)
        // d/dtheta of (theta - mean)^2 / (2 sd^2)
        result.gradient[k] = (theta[k] - unknowns_[k].mean) / std::pow(unknowns_[k].sd, 2);
    if (num_observed_rows() == 0) return result;
    if (!is_stable(theta)) {
        result.objective = std::numeric_limits<double>::infinity();
        return result;
    }
    const Response response = respond(theta);
    // F = 1/2 e^T C^-1 e + 1/2 ln det C + prior, det C = det R det M (method.md, 4.1)
    result.log_determinant =
        noise_log_determinant_ + 2.0 * response.inner.matrixLLT().diagonal().array().log().sum();
    result.objective += 0.5 * response.misfit + 0.5 * result.log_determinant;
    if (with_gradient) add_gradient(response, result.gradient);
    return result;
}

std::vector<double> LinearisedProblem::objectives(
    const std::vector<Eigen::VectorXd>& thetas) const {
    std::vector<double> values(thetas.size());
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(thetas.size()), 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) values[k] = evaluate(thetas[k], false).objective;
    });
    return values;
}

// u_d = m + H^-1 N^T J^T alpha - D L w, J^T alpha = -T^T S^-1 V^T G_o^T alpha, w the motion's part
// that is the frame's.
LinearisedProblem::Fit LinearisedProblem::fit(const Eigen::VectorXd& theta) const {
    Fit result;
    result.driven = walls_.mean();
    result.frame = walls_.frame_mean();
    if (num_observed_rows() == 0) return result;
    const Response response = respond(theta);
    // |alpha|^2 = e^T C^-1 e - |w|^2, tr C^-1 R = rows - rank + tr M^-1 (method.md, 4.5)
    result.weighted_misfit = response.misfit - response.motion.squaredNorm();  // |alpha|^2
    Eigen::MatrixXd root_inverse = Eigen::MatrixXd::Identity(rank(), rank());
    response.inner.matrixL().solveInPlace(root_inverse);
    result.effective_rows =
        static_cast<double>(num_observed_rows() - rank()) + root_inverse.squaredNorm();
    // r = y + G_o V z, z = s + X w;  tr(D R C^-1 R) = tr D R - tr(M^-1 (J P)^T D J P),
    // J P = -G_o V X.
    const auto moved = response.shapes.leftCols(rank());
    const Eigen::VectorXd shape = response.shapes.col(rank()) + moved * response.motion;
    const Eigen::VectorXd residual = observed_.target + observed_.along_modes * shape;
    result.slice_share = slice_share_of(observed_.rows, residual);
    const Eigen::VectorXd weights = weights_of(observed_.rows);
    result.misfit_mm2 = weights.dot(residual.cwiseAbs2());
    // tr(M^-1 (J P)^T D J P) = |L^-1 (J P)^T D^1/2|^2, M = L L^T
    Eigen::MatrixXd explained =
        (observed_.along_modes * moved).transpose() * weights.cwiseSqrt().asDiagonal();
    response.inner.matrixL().solveInPlace(explained);
    result.expected_misfit_mm2 = noise_trace_ - explained.squaredNorm();
    const Eigen::VectorXd force =
        -(model_.coupling(response.kpa).transpose() *
          response.equilibrium.solve(response.pull.head(model_.num_modes())));
    result.driven += walls_.conditioned(model_.spread() * force);
    if (frame_.size() == 0) return result;
    const FrameMotion further = walls_.frame_root() * response.motion.tail<6>();
    result.frame += further;
    result.driven -= walls_.frame_spread() * further;
    return result;
}

// With dJ = -G_o V dX, dX = S^-1 (T' - S' X), and the most probable motion c = N m + P w:
//   dF = <dJ, W>,  W = C^-1 J P P^T - alpha c^T = (B M^-1 - alpha w^T) P^T - alpha (N m)^T.
// In the columns [P | N m] of `shapes` and `coupling_`, W is [B M^-1 - alpha w^T | -alpha], and
// V^T G_o^T B = -I X.
void LinearisedProblem::add_gradient(const Response& response, Eigen::VectorXd& gradient) const {
    const Index modes = model_.num_modes();
    const auto informed = response.informed.topLeftCorner(modes, rank());
    const auto pull = response.pull.head(modes);
    Eigen::MatrixXd adjoint(modes, rank() + 1);
    // V^T G^T W = -[I X M^-1 + pull w^T | pull], then S^-1 of it
    adjoint.leftCols(rank()) = -response.inner.solve(informed.transpose()).transpose();
    adjoint.leftCols(rank()) -= pull * response.motion.transpose();
    adjoint.col(rank()) = -pull;
    response.equilibrium.solve_in_place(adjoint);
    const auto shapes = response.shapes.topRows(modes);
    const bool is_diagonal = num_unknown() == 1 && model_.is_diagonal_in(unknown_[0]);
    const Eigen::MatrixXd moment =
        is_diagonal ? Eigen::MatrixXd(adjoint.cwiseProduct(shapes).rowwise().sum().asDiagonal())
                    : Eigen::MatrixXd(adjoint * shapes.transpose());
    for (Index k = 0; k < num_unknown(); ++k) {
        for (std::size_t r = 0; r < coupling_.size(); ++r) {
            const auto& region = model_.regions()[r];
            if (region.region != unknown_[k]) continue;
            // dF/d ln E_r = E_r (<S_r, S^-1 W X^T> - <T_r, S^-1 W>)
            double change = region.stiffness.cwiseProduct(moment).sum();
            if (coupling_[r].size() > 0) change -= coupling_[r].cwiseProduct(adjoint).sum();
            gradient[k] += response.kpa[region.region] * change;
        }
    }
}

// G^T (H^-1 - H^-1 N^T J^T C^-1 J N H^-1) G
Eigen::MatrixXd LinearisedProblem::motion_covariance(const Eigen::VectorXd& theta,
                                                     const Eigen::MatrixXd& functionals) const {
    Eigen::MatrixXd conditioned = prior_.covariance_times(functionals);
    for (Index c = 0; c < conditioned.cols(); ++c) {
        conditioned.col(c) = walls_.conditioned(conditioned.col(c));
    }
    // With the frame: H^-1 + D M^-1 D^T, and -cov(delta, G u_d) = M^-1 D^T G.
    Eigen::MatrixXd along_frame(frame_.size(), functionals.cols());
    if (frame_.size() > 0) {
        const Eigen::MatrixXd shared = walls_.frame_spread().transpose() * functionals;
        along_frame = walls_.frame_root() * (walls_.frame_root().transpose() * shared);
        conditioned += walls_.frame_spread() * along_frame;
    }
    const Eigen::MatrixXd by_walls = functionals.transpose() * conditioned;
    if (num_observed_rows() == 0) return by_walls;
    const Response response = respond(theta);
    Eigen::MatrixXd moved(model_.num_modes() + frame_.size(), functionals.cols());
    moved << response.equilibrium.solve(model_.coupling(response.kpa) *
                                        (model_.functionals() * conditioned)),
        along_frame;
    const Eigen::MatrixXd seen =
        response.informed.leftCols(rank()).transpose() * moved;  // B^T J ..
    // A - Z^T I Z + (B^T J ..)^T M^-1 (B^T J ..): C^-1 = 1 - B M^-1 B^T again
    return by_walls - moved.transpose() * (information_ * moved) +
           seen.transpose() * response.inner.solve(seen);
}

// J c = -G_o V x, S x = T c: the change of x is S^-1 (T' c - S' x), with c = N m + P w; none of the
// frame's modes.
Eigen::MatrixXd LinearisedProblem::change_of_shape(const Response& response,
                                                   const Eigen::VectorXd& motion) const {
    const Index modes = model_.num_modes();
    Eigen::VectorXd all(rank() + 1);
    all << motion, 1.0;
    const Eigen::VectorXd shape = response.shapes.topRows(modes) * all;
    Eigen::MatrixXd change = Eigen::MatrixXd::Zero(modes, num_unknown());
    for (Index k = 0; k < num_unknown(); ++k) {
        for (std::size_t r = 0; r < coupling_.size(); ++r) {
            const auto& region = model_.regions()[r];
            if (region.region != unknown_[k]) continue;
            const double kpa = response.kpa[region.region];
            // dx/d ln E_r = S^-1 E_r (T_r c - S_r x)
            change.col(k) -= kpa * (region.stiffness * shape);
            if (coupling_[r].size() > 0) change.col(k) += kpa * (coupling_[r] * all);
        }
    }
    response.equilibrium.solve_in_place(change);
    Eigen::MatrixXd with_frame = Eigen::MatrixXd::Zero(modes + frame_.size(), num_unknown());
    with_frame.topRows(modes) = change;
    return with_frame;
}

Eigen::MatrixXd LinearisedProblem::shapes(const Eigen::VectorXd& theta) const {
    return respond(theta).shapes;
}

Eigen::MatrixXd LinearisedProblem::change_of_shape(const Eigen::VectorXd& theta,
                                                   const Eigen::VectorXd& motion) const {
    return change_of_shape(respond(theta), motion);
}

Eigen::MatrixXd LinearisedProblem::seen_information(const Eigen::VectorXd& theta) const {
    if (num_observed_rows() == 0) return Eigen::MatrixXd::Zero(num_unknown(), num_unknown());
    const Response response = respond(theta);
    const Eigen::MatrixXd change = change_of_shape(response, response.motion);
    const Eigen::MatrixXd unseen = response.informed.leftCols(rank()).transpose() * change;
    // D^T C^-1 D with D = -G V dx/d ln E (method.md, 5.2)
    return change.transpose() * information_ * change -
           unseen.transpose() * response.inner.solve(unseen);
}

Eigen::MatrixXd LinearisedProblem::hessian(const Eigen::VectorXd& theta) const {
    constexpr double step = 1e-3;  // of ln E: 0.1 %, far above the rounding of the gradient
    const Index n = num_unknown();
    Eigen::MatrixXd change(n, 2 * n);  // gradients above, then below
    const SerialBlas serial;
    parallel_ranges(2 * n, 1, [&](Index begin, Index end) {
        for (Index c = begin; c < end; ++c) {
            Eigen::VectorXd at = theta;
            at[c % n] += c < n ? step : -step;
            change.col(c) = evaluate(at, true).gradient;
        }
    });
    // (g(theta + h) - g(theta - h)) / 2 h, then made symmetric
    const Eigen::MatrixXd hessian = (change.leftCols(n) - change.rightCols(n)) / (2.0 * step);
    return 0.5 * (hessian + hessian.transpose());
}

}  // namespace palpate
