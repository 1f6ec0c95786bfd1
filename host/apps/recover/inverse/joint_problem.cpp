// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/inverse/joint_problem.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "host/apps/recover/inverse/reduced_model.hpp"
#include "solver/base/parallel.hpp"
#include "solver/base/serial_blas.hpp"

namespace palpate {
namespace {

constexpr double share_of_reference = 0.5;

/// Places of the reference at which its contours are wrong for all targets alike.
class CommonPlaces {
public:
    Index number_of(const LinearRow& row) {
        const std::array<double, 4> key{double(row.surface), row.place.x(), row.place.y(),
                                        row.place.z()};
        const auto [known, is_new] = numbers_.try_emplace(key, static_cast<Index>(rows_.size()));
        if (is_new) rows_.push_back(row);
        return known->second;
    }
    /// L with L L^T half the correlation between all places.
    Eigen::MatrixXd root() const {
        constexpr double nugget = 1e-12;
        if (rows_.empty()) return Eigen::MatrixXd::Identity(1, 1);  // BLAS takes no empty matrices
        const Index n = static_cast<Index>(rows_.size());
        Eigen::MatrixXd half = Eigen::MatrixXd::Zero(n, n);
        for (Index j = 0; j < n; ++j) {
            // K_ij / 2, K of places on one surface (method.md, 2.2); others have nothing in common.
            half(j, j) = share_of_reference * contour_correlation(rows_[j], rows_[j]) + nugget;
            for (Index i = j + 1; i < n; ++i) {
                if (rows_[i].surface != rows_[j].surface) continue;
                half(i, j) = share_of_reference * contour_correlation(rows_[i], rows_[j]);
            }
        }
        return cholesky(half, "correlation of the reference's contours").matrixL();
    }

private:
    std::map<std::array<double, 4>, Index> numbers_;
    std::vector<LinearRow> rows_;
};

/// The noise of one target's rows without the reference's contours: R_aa - 1/2 D_a K D_a.
Eigen::MatrixXd own_noise(const std::vector<LinearRow>& rows) {
    const Index n = static_cast<Index>(rows.size());
    Eigen::MatrixXd noise(n, n);
    for (Index j = 0; j < n; ++j) {
        const LinearRow& row = rows[j];
        // B = R - 1/2 D K D, D the contour deviation of each row
        noise(j, j) = noise_variance(row) - share_of_reference * contour_variance(row);
        for (Index i = j + 1; i < n; ++i) {
            noise(i, j) = noise_covariance(rows[i], row);
            if (rows[i].surface != row.surface) continue;
            noise(i, j) -= share_of_reference * rows[i].contour_mm * row.contour_mm *
                           contour_correlation(rows[i], row);
        }
    }
    return noise;
}

}  // namespace

// B is the noise of a target's own, U U^T with U = D L what the reference's contours add to it.
struct JointProblem::Target {
    std::shared_ptr<const LinearisedProblem> problem;
    Eigen::MatrixXd information;    ///< V^T G^T B^-1 G V
    Eigen::VectorXd pull;           ///< V^T G^T B^-1 y
    Eigen::MatrixXd common_modes;   ///< U^T B^-1 G V
    Eigen::VectorXd common_target;  ///< U^T B^-1 y
    double misfit = 0;              ///< y^T B^-1 y
};

// Given z ~ N(0, 1), what the reference's contours are, targets are independent: with
// C_a = B_a + (G V X)_a (G V X)_a^T each one's own covariance,
//   ln det C = sum_a ln det C_a + ln det T,   T = 1 + sum_a U_a^T C_a^-1 U_a,
//   e^T C^-1 e = sum_a e_a^T C_a^-1 e_a - g^T T^-1 g,   g = sum_a U_a^T C_a^-1 e_a.
struct JointProblem::Response {
    struct Own {
        Eigen::MatrixXd free;               ///< X [modes, rank]
        Eigen::MatrixXd informed;           ///< V^T G^T B^-1 G V X
        Eigen::MatrixXd common;             ///< U^T B^-1 G V X
        Eigen::LLT<Eigen::MatrixXd> inner;  ///< of M = 1 + X^T V^T G^T B^-1 G V X
        Eigen::VectorXd motion;             ///< w, as if z = 0
    };
    std::vector<Own> targets;
    Eigen::LLT<Eigen::MatrixXd> common;  ///< of T
    Eigen::VectorXd contours;            ///< the most probable z, T^-1 g
    double misfit = 0;                   ///< e^T C^-1 e
    double log_determinant = 0;          ///< of C
};

JointProblem::JointProblem(const std::vector<std::shared_ptr<const LinearisedProblem>>& targets) {
    CommonPlaces places;
    std::vector<std::vector<Index>> at;
    for (const auto& target : targets) {
        at.emplace_back();
        for (const LinearRow& row : target->observed_rows().rows)
            at.back().push_back(places.number_of(row));
    }
    const Eigen::MatrixXd root = places.root();
    common_information_.setIdentity(root.rows(), root.rows());
    for (std::size_t a = 0; a < targets.size(); ++a) {
        const ObservedRows& seen = targets[a]->observed_rows();
        Target target{targets[a], {}, {}, {}, {}, 0};
        Eigen::MatrixXd modes = seen.along_modes, common(seen.rows.size(), root.cols());
        Eigen::VectorXd wanted = seen.target;
        for (std::size_t i = 0; i < seen.rows.size(); ++i)
            // U = D L, so that U U^T = 1/2 D K D
            common.row(i) = seen.rows[i].contour_mm * root.row(at[a][i]);
        target.information.setZero(modes.cols(), modes.cols());
        target.pull.setZero(modes.cols());
        target.common_modes.setZero(root.cols(), modes.cols());
        target.common_target.setZero(root.cols());
        if (!seen.rows.empty()) {  // BLAS takes no empty matrices
            const auto factor = cholesky(own_noise(seen.rows), "covariance of a target's noise");
            // B = L L^T: L^-1 G V, L^-1 U and L^-1 y, whose products are those with B^-1.
            for (Eigen::MatrixXd* rows : {&modes, &common}) factor.matrixL().solveInPlace(*rows);
            factor.matrixL().solveInPlace(wanted);
            noise_log_determinant_ += 2.0 * factor.matrixLLT().diagonal().array().log().sum();
            target.information = modes.transpose() * modes;
            target.pull = modes.transpose() * wanted;
            target.common_modes = common.transpose() * modes;
            target.common_target = common.transpose() * wanted;
            target.misfit = wanted.squaredNorm();
            common_information_ += common.transpose() * common;
        }
        targets_.push_back(std::move(target));
    }
}

JointProblem::~JointProblem() = default;

const std::vector<Unknown>& JointProblem::unknowns() const {
    return targets_[0].problem->unknowns();
}

JointProblem::Response JointProblem::respond(const Eigen::VectorXd& theta) const {
    Response response;
    response.log_determinant = noise_log_determinant_;
    Eigen::MatrixXd common = common_information_;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(common.rows());
    for (const Target& target : targets_) {
        const Index rank = target.problem->rank();
        const Eigen::MatrixXd shapes = target.problem->shapes(theta);
        const Eigen::VectorXd mean = shapes.col(rank);
        Response::Own own;
        own.free = shapes.leftCols(rank);
        own.informed = target.information * own.free;
        own.common = target.common_modes * own.free;
        Eigen::MatrixXd inner = own.free.transpose() * own.informed;
        inner.diagonal().array() += 1.0;
        own.inner = cholesky(inner, "covariance of a target's observed surface");
        // w = M^-1 (G V X)^T B^-1 e, e = y + G V s, all in modes; ln det C_a = ln det B + ln det M
        const Eigen::VectorXd pull_of_error = target.pull + target.information * mean;
        const Eigen::VectorXd seen_error = -(own.free.transpose() * pull_of_error);
        own.motion = own.inner.solve(seen_error);
        response.misfit +=
            target.misfit + mean.dot(target.pull + pull_of_error) - own.motion.dot(seen_error);
        response.log_determinant += 2.0 * own.inner.matrixLLT().diagonal().array().log().sum();
        pull += target.common_target + target.common_modes * mean + own.common * own.motion;
        Eigen::MatrixXd known = own.common.transpose();
        own.inner.matrixL().solveInPlace(known);
        // U^T C_a^-1 U = U^T B^-1 U - (U^T B^-1 G V X) M^-1 (..)^T, summed over targets into T
        common -= known.transpose() * known;
        response.targets.push_back(std::move(own));
    }
    response.common = cholesky(common, "covariance of the reference's contours");
    // z = T^-1 g; e^T C^-1 e = sum - g^T z, ln det C = sum + ln det T (method.md, 6.2 and 6.3)
    response.contours = response.common.solve(pull);
    response.misfit -= pull.dot(response.contours);
    response.log_determinant += 2.0 * response.common.matrixLLT().diagonal().array().log().sum();
    return response;
}

double JointProblem::value(const Eigen::VectorXd& theta) const {
    const Response response = respond(theta);
    // F = 1/2 e^T C^-1 e + 1/2 ln det C + prior (method.md, 6.1)
    return prior_energy(unknowns(), theta) + 0.5 * (response.misfit + response.log_determinant);
}

JointProblem::Evaluation JointProblem::evaluate(const Eigen::VectorXd& theta,
                                                bool with_gradient) const {
    constexpr double step = 1e-3;  // of ln E
    const Index n = num_unknown();
    std::vector<Eigen::VectorXd> points{theta};
    for (Index k = 0; with_gradient && k < n; ++k) {
        points.push_back(theta + step * Eigen::VectorXd::Unit(n, k));
        points.push_back(theta - step * Eigen::VectorXd::Unit(n, k));
    }
    const std::vector<double> values = objectives(points);
    Evaluation result;
    result.objective = values[0];
    result.gradient = Eigen::VectorXd::Zero(n);
    for (Index k = 0; with_gradient && k < n; ++k)
        // (F(theta + h) - F(theta - h)) / 2 h
        result.gradient[k] = (values[1 + 2 * k] - values[2 + 2 * k]) / (2.0 * step);
    return result;
}

std::vector<double> JointProblem::objectives(const std::vector<Eigen::VectorXd>& thetas) const {
    std::vector<double> values(thetas.size());
    const SerialBlas serial;
    parallel_ranges(static_cast<Index>(thetas.size()), 1, [&](Index begin, Index end) {
        for (Index k = begin; k < end; ++k) values[k] = value(thetas[k]);
    });
    return values;
}

Eigen::MatrixXd JointProblem::hessian(const Eigen::VectorXd& theta) const {
    constexpr double stride = 0.05;  // of ln E: second differences of F itself
    const Index n = num_unknown();
    std::vector<Eigen::VectorXd> points{theta};
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b <= a; ++b)
            for (const double sign : {1.0, -1.0})
                points.push_back(theta + sign * stride *
                                             (Eigen::VectorXd::Unit(n, a) +
                                              (a == b ? Eigen::VectorXd::Zero(n).eval()
                                                      : Eigen::VectorXd::Unit(n, b).eval())));
    const std::vector<double> values = objectives(points);
    // d^T H d along each direction d, then H_ab from those of a, b and a + b.
    Eigen::MatrixXd along(n, n);
    std::size_t next = 1;
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b <= a; ++b, next += 2)
            along(a, b) = (values[next] + values[next + 1] - 2.0 * values[0]) / (stride * stride);
    Eigen::MatrixXd hessian(n, n);
    for (Index a = 0; a < n; ++a)
        for (Index b = 0; b <= a; ++b)
            hessian(a, b) = hessian(b, a) =
                // (a + b)^T H (a + b) = H_aa + 2 H_ab + H_bb
                a == b ? along(a, a) : 0.5 * (along(a, b) - along(a, a) - along(b, b));
    return hessian;
}

Eigen::MatrixXd JointProblem::shares(const Eigen::VectorXd& theta) const {
    const Eigen::VectorXd all = seen_information(theta).diagonal();
    Eigen::MatrixXd shares(targets_.size(), num_unknown());
    for (std::size_t a = 0; a < targets_.size(); ++a) {
        const Eigen::VectorXd one = targets_[a].problem->seen_information(theta).diagonal();
        for (Index k = 0; k < num_unknown(); ++k)
            shares(a, k) = one[k] < all[k] ? one[k] / all[k] : 1.0;
    }
    return shares;
}

// J is what a change of theta does to the rows, G V dX: J^T C^-1 J with C as above, w that of the
// most probable contours.
Eigen::MatrixXd JointProblem::seen_information(const Eigen::VectorXd& theta) const {
    const Response response = respond(theta);
    const Index n = num_unknown();
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd common = Eigen::MatrixXd::Zero(common_information_.rows(), n);  // U^T C_a^-1 J
    for (std::size_t a = 0; a < targets_.size(); ++a) {
        const Target& target = targets_[a];
        const Response::Own& own = response.targets[a];
        const Eigen::VectorXd motion =
            own.motion + own.inner.solve(own.common.transpose() * response.contours);
        const Eigen::MatrixXd change = target.problem->change_of_shape(theta, motion);
        const Eigen::MatrixXd unseen = own.informed.transpose() * change;
        const Eigen::MatrixXd free = own.inner.solve(unseen);
        // D^T C^-1 D (method.md, 5.2) = sum D_a^T C_a^-1 D_a - (sum U_a^T C_a^-1 D_a)^T T^-1 (..)
        information += change.transpose() * target.information * change - unseen.transpose() * free;
        common += target.common_modes * change - own.common * free;
    }
    return information - common.transpose() * response.common.solve(common);
}

}  // namespace palpate
