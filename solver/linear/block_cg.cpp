// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "solver/linear/block_cg.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr int first_look = 4;       ///< iterations before the host first reads the residuals
constexpr int longest_wait = 100;   ///< between two looks
constexpr double wait_share = 0.8;  ///< of the iterations that the rate so far predicts
constexpr int fewest_left = 3;      ///< predicted iterations for which narrowing pays

std::span<const double> as_span(const Columns& c) {
    return {c.data(), static_cast<std::size_t>(c.size())};
}

std::vector<Index> first_columns(Index count) {
    std::vector<Index> columns(count);
    std::iota(columns.begin(), columns.end(), 0);
    return columns;
}

}  // namespace

Index padded_columns(Index columns) {
    if (columns <= 1) return 1;
    if (columns <= 4) return 4;
    if (columns <= 8) return 8;
    return (columns + 15) / 16 * 16;
}

BlockCg::BlockCg(Backend& backend, const DeviceOperator& matrix, Preconditioner& preconditioner,
                 Curvature curvature)
    : backend_(backend), matrix_(matrix), preconditioner_(preconditioner), curvature_(curvature) {}

std::unique_ptr<BlockCg::Workspace> BlockCg::make_workspace(Index columns) {
    const Index rows = matrix_.rows();
    auto w = std::make_unique<Workspace>();
    for (auto* vector : {&w->x, &w->r, &w->z, &w->p, &w->q})
        *vector = backend_.make_vector(rows, columns);
    for (auto* sums : {&w->rz[0], &w->rz[1], &w->rr[0], &w->rr[1], &w->pq, &w->limit})
        *sums = backend_.make_sums(columns);
    return w;
}

BlockCg::Workspace& BlockCg::full_workspace(Index columns) {
    if (!full_ || full_->x->columns() != columns) {
        full_.reset();
        preconditioner_.keep_only(columns);
        full_ = make_workspace(columns);
    }
    return *full_;
}

/// One solve. Columns of the current workspace are called slots: slot s holds column
/// `column_of_[s]` of the right-hand side, or padding.
class BlockCg::Run {
public:
    Run(BlockCg& cg, const Columns& r, std::span<const double> target)
        : cg_(cg),
          backend_(cg.backend_),
          columns_(static_cast<Index>(r.cols())),
          full_(cg.full_workspace(padded_columns(columns_))),
          w_(&full_),
          column_of_(first_columns(columns_)) {
        // A column is done at r.r <= target^2: no roots on the device.
        for (double t : target) limit_.push_back(t * t);
        const Index width = full_.x->columns();
        // Padding has r.r = 0, which does not exceed its limit of 0: it stays as it is.
        Columns padded = Columns::Zero(r.rows(), width);
        padded.leftCols(columns_) = r;
        backend_.copy_in(as_span(width == columns_ ? r : padded), *full_.r);
        backend_.fill(*full_.x, 0);
        write_limits();
        // x = 0, r = b, r.r
        backend_.dot(*full_.r, *full_.r, *full_.rr[0]);
    }

    int iterate(int max_iterations) {
        if (!look(0) || max_iterations <= 0) return 0;
        // beta = r.z / 0 counts as 0 on the device, so that the first direction is p = z.
        backend_.set(*w_->rz[now_], std::vector<double>(w_->x->columns(), 0.0));
        precondition_and_turn();  // from no direction: p = z
        int next_look = std::min(first_look, max_iterations);
        for (int iteration = 1;; ++iteration) {
            // q = K p, p.q (method.md, 11.2)
            backend_.apply(cg_.matrix_, *w_->p, *w_->q, w_->pq.get());
            if (cg_.curvature_ == Curvature::watched && is_not_positive()) return iteration;
            // alpha = r.z / p.q, x += alpha p, r -= alpha q, r.r (method.md, 11.2)
            backend_.advance(*w_->rz[now_], *w_->pq, *w_->rr[rr_now_], *w_->limit, *w_->p, *w_->q,
                             *w_->x, *w_->r, *w_->rr[1 - rr_now_]);
            rr_now_ = 1 - rr_now_;
            if (iteration == next_look) {
                if (!look(iteration) || iteration >= max_iterations) return iteration;
                narrow();
                next_look = std::min(iteration + wait_, max_iterations);
            }
            precondition_and_turn();
        }
    }

    void copy_out(Columns& dx) {
        if (w_ != &full_) return_columns();
        const Index width = full_.x->columns();
        Columns padded(full_.x->rows(), width);
        backend_.copy_out(*full_.x, {padded.data(), static_cast<std::size_t>(padded.size())});
        if (width == columns_)
            dx = std::move(padded);
        else
            dx = padded.leftCols(columns_);
    }

private:
    Index num_slots() const { return static_cast<Index>(column_of_.size()); }

    void precondition_and_turn() {
        // z = M^-1 r, beta = r.z / (r.z before), p = z + beta p (method.md, 11.2)
        cg_.preconditioner_.apply(*w_->r, *w_->z, *w_->rz[1 - now_]);
        backend_.turn(*w_->rz[1 - now_], *w_->rz[now_], *w_->z, *w_->p);
        now_ = 1 - now_;
    }

    /// Whether the present directions show that K or its preconditioner is not positive definite.
    bool is_not_positive() {
        // p.K p <= 0 or r.M^-1 r <= 0 in a column that is not done: K or M is not positive
        // definite.
        std::vector<double> pq(w_->x->columns()), rz = pq, rr = pq;
        backend_.read(*w_->pq, pq);
        backend_.read(*w_->rz[now_], rz);
        backend_.read(*w_->rr[rr_now_], rr);
        for (Index s = 0; s < num_slots(); ++s)
            if (rr[s] > limit_[column_of_[s]] && !(pq[s] > 0 && rz[s] > 0))
                cg_.met_negative_curvature_ = true;
        return cg_.met_negative_curvature_;
    }

    void write_limits() {
        std::vector<double> limits(w_->x->columns(), 0.0);
        for (Index s = 0; s < num_slots(); ++s) limits[s] = limit_[column_of_[s]];
        backend_.set(*w_->limit, limits);
    }

    /// Reads the residuals; false if no column needs to go on. Plans the next look.
    bool look(int iteration) {
        std::vector<double> rr(w_->x->columns());
        backend_.read(*w_->rr[rr_now_], rr);
        if (iteration == 0) start_.assign(rr.begin(), rr.begin() + columns_);
        open_.clear();
        double fewest = longest_wait, most = 0;
        for (Index s = 0; s < num_slots(); ++s) {
            if (!std::isfinite(rr[s]))
                throw Error(ErrorCode::solve_failed,
                            "Conjugate gradients met a value that is not a finite number; try "
                            "double precision, or check the mesh for flat elements.");
            const double limit = limit_[column_of_[s]];
            // The same r.r to the last bit twice: nothing more is to be had in this precision.
            const bool stands_still = iteration > 0 && !seen_.empty() && rr[s] == seen_[s];
            if (rr[s] <= limit || stands_still) continue;
            open_.push_back(s);
            // |r| falls by a rate per iteration: left = iteration ln(rr / limit) / ln(rr_0 / rr).
            const double gained = std::log(start_[column_of_[s]] / rr[s]);
            const double missing = std::log(rr[s] / std::max(limit, 1e-300));
            const double left = gained > 0 ? missing * iteration / gained : longest_wait;
            fewest = std::min(fewest, left);
            most = std::max(most, left);
        }
        seen_ = rr;
        most_left_ = std::min<double>(most, longest_wait);
        // Several columns: look when the first is done, it may be time to narrow.
        const bool may_narrow = padded_columns(static_cast<Index>(open_.size())) > 1;
        wait_ = std::clamp(static_cast<int>(wait_share * (may_narrow ? fewest : most_left_)), 1,
                           longest_wait);
        return !open_.empty();
    }

    /// Goes on with the open columns in the narrowest vectors that hold them, if that is at most
    /// half the present width and enough is left to do.
    void narrow() {
        const Index width = padded_columns(static_cast<Index>(open_.size()));
        if (2 * width > w_->x->columns() || most_left_ < fewest_left) return;
        std::vector<double> rz(w_->x->columns()), rr = seen_;
        backend_.read(*w_->rz[now_], rz);
        auto narrow = cg_.make_workspace(width);
        const std::vector<Index> slots = first_columns(static_cast<Index>(open_.size()));
        // x, r and p with r.z and r.r are all that the recurrence (method.md, 11.2) carries on;
        // z and q are made anew in each iteration.
        for (auto vector : {&Workspace::x, &Workspace::r, &Workspace::p}) {
            backend_.fill(*((*narrow).*vector), 0);
            backend_.copy_columns(*(w_->*vector), open_, *((*narrow).*vector), slots);
        }
        return_columns();
        std::vector<double> open_rz(width, 0.0), open_rr(width, 0.0);
        std::vector<Index> columns;
        for (Index s : slots) {
            open_rz[s] = rz[open_[s]];
            open_rr[s] = rr[open_[s]];
            columns.push_back(column_of_[open_[s]]);
        }
        column_of_ = std::move(columns);
        narrow_ = std::move(narrow);
        w_ = narrow_.get();
        now_ = rr_now_ = 0;
        backend_.set(*w_->rz[0], open_rz);
        backend_.set(*w_->rr[0], open_rr);
        write_limits();
        seen_ = std::move(open_rr);
    }

    /// Brings the solutions of a narrow workspace back to the full one.
    void return_columns() {
        if (w_ != &full_)
            backend_.copy_columns(*w_->x, first_columns(num_slots()), *full_.x, column_of_);
    }

    BlockCg& cg_;
    Backend& backend_;
    Index columns_;
    Workspace& full_;
    std::unique_ptr<Workspace> narrow_;
    Workspace* w_;
    std::vector<Index> column_of_;
    std::vector<double> limit_;  ///< [columns] target^2
    std::vector<double> start_;  ///< [columns] |r|^2 at the start
    std::vector<double> seen_;   ///< [slots] |r|^2 at the last look
    std::vector<Index> open_;    ///< slots that have not converged
    int now_ = 0;                ///< which of the two rz holds that of the present directions
    int rr_now_ = 0;
    double most_left_ = 0;  ///< predicted iterations
    int wait_ = 1;          ///< iterations until the next look
};

int BlockCg::solve(const Columns& r, std::span<const double> target, int max_iterations,
                   Columns& dx) {
    met_negative_curvature_ = false;
    Run run(*this, r, target);
    const int iterations = run.iterate(max_iterations);
    run.copy_out(dx);
    return iterations;
}

}  // namespace palpate
