// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours/contour_tracker.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "host/apps/aspirate/contours/column_loops.hpp"
#include "host/apps/aspirate/contours/outline_islands.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr Index first_rows = 12;     // surely above the outline in the first frame
constexpr float most_evidence = 6;   // of one pixel for tissue
constexpr float most_against = 4;    // and against it: stains may look like the background
constexpr float temperature = 0.6F;  // neighbours share pixels: their evidence counts less
constexpr float step_reward = 2.5, derivative_reward = 1.5;
constexpr float full_part = 0.25;  // of the tissue's contrast earns the full reward
constexpr float bend_weight = 1.2F, bend_curvature = 1.5F;
constexpr float most_spread = 0.4F;   // of the tissue's light, as a part of it
constexpr float darkest_part = 0.5F;  // of the tissue's median light
constexpr float slope_share = 0.5F, guess_weight = 0.1F;
constexpr float jump_weight = 0.4F;    // per row from where the frame before lets expect it
constexpr float most_jump = 12;        // rows
constexpr Index far_rows = 3;          // another outline differs by more
constexpr float least_margin = 9;      // of costs, or the outline is a guess
constexpr Index edge_reach = 2;        // rows from the path to the steepest place
constexpr double most_more_reach = 4;  // rows, on a flank
constexpr double sd_sigmas = 2, most_more = 0.5;  // of its own error, too, half a pixel more
constexpr float fair_sd = 2.5;  // pixels, of a fitted edge; beyond it the path knows better
// A step that is not the tissue's makes an error of share (|ln of their quotient| - free)
constexpr float other_share = 1.2, other_free = 0.35;
constexpr float shape_sigmas = 3;               // of the spread round the shape
constexpr float least_far = 1.5, most_far = 2;  // pixels from the shape that are too far
constexpr float misfit_share = 1.7;             // of what a bad fit of the edge could do
constexpr double texture_share = 0.9;           // of what the tissue's slopes of light could do

Index searched_rows(const ContourSettings& settings) {
    return std::clamp<Index>(Index(std::floor(settings.visible_rows)) - 2, 0, settings.height - 4);
}

float median_of(std::vector<float>& values) {
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

ContourTracker::ContourTracker(const ContourSettings& settings)
    : settings_(settings),
      width_(settings.width),
      rows_(searched_rows(settings)),
      stride_((rows_ + 19) / 8 * 8),  // some rows more, of eight
      background_(width_, rows_),
      search_(width_, rows_ + 1),
      shape_(width_),
      still_(width_, rows_, stride_) {
    if (width_ < 32 || rows_ < 24)
        throw Error(ErrorCode::input_unusable,
                    "frames need at least 32 columns and 24 rows above the line of visibility; "
                    "they have " +
                        std::to_string(width_) + " and " + std::to_string(rows_));
    for (auto* field : {&columns_, &residual_, &smooth_, &column_sum_})
        field->assign(std::size_t(width_ * stride_), 0.0F);
    for (auto* line :
         {&tissue_, &tissue_new_, &slope_, &top_, &raw_row_, &raw_sd_, &joined_row_, &joined_sd_,
          &margin_, &weight_, &step_, &misfit_, &per_variance_, &last_row_, &last_velocity_})
        line->assign(std::size_t(width_), 0.0F);
    window_.reserve(std::size_t(std::max<Index>(64, 2 * width_)));
    is_good_.assign(std::size_t(width_), 0);
    outline_.resize(std::size_t(width_));
}

const Outline& ContourTracker::add(const GreyFrame& frame) {
    if (frame.width != width_ || frame.height != settings_.height)
        throw Error(ErrorCode::input_unusable,
                    "a frame of " + std::to_string(frame.width) + " x " +
                        std::to_string(frame.height) + " pixels among frames of " +
                        std::to_string(width_) + " x " + std::to_string(settings_.height));
    load(frame);
    if (!has_begun_) begin();
    smooth_residuals();
    search();
    learn_tissue();
    fit_edges();
    join_columns();
    judge();
    remember();
    return outline_;
}

/// Columns side by side, tissue brighter.
void ContourTracker::load(const GreyFrame& frame) {
    const Index end = std::min(rows_ + 4, settings_.height);
    turn_columns(frame.grey.data(), width_, end, stride_, columns_.data());
    if (!settings_.is_brighter)
        for (float& grey : columns_) grey = 255 - grey;
}

/// The first frame: background and tissue are not known yet and take turns.
void ContourTracker::begin() {
    std::fill(top_.begin(), top_.end(), float(first_rows));
    for (int round = 0; round < 4; ++round) {
        background_.begin(columns_, stride_, top_);
        smooth_residuals();
        if (round == 0) {  // half of the frame's lowest rows that are seen is tissue
            window_.clear();
            for (Index x = 0; x < width_; ++x) window_.push_back(smooth_[x * stride_ + rows_ - 3]);
            std::sort(window_.begin(), window_.end());
            const float bright =
                std::max(window_[std::size_t(0.7 * double(window_.size()))], 12 * smooth_sigma_);
            std::fill(tissue_.begin(), tissue_.end(), bright);
            tissue_sd_ = 0.4F * bright;
        }
        search();
        learn_tissue();
        for (Index x = 0; x < width_; ++x) top_[x] = float(visible_row(x)) - 6;
    }
    has_begun_ = true;
}

/// What pixels show beyond the background, alone and as means of three by three.
void ContourTracker::smooth_residuals() {
    for (Index x = 0; x < width_; ++x)
        take_background(&columns_[x * stride_], background_.column(x).data(), rows_ + 4,
                        &residual_[x * stride_], &column_sum_[x * stride_]);
    for (Index x = 0; x < width_; ++x)
        mean_of_nine(&column_sum_[std::max<Index>(x - 1, 0) * stride_], &column_sum_[x * stride_],
                     &column_sum_[std::min(x + 1, width_ - 1) * stride_], rows_ + 3,
                     &smooth_[x * stride_]);
    // Noise of the means, with what the field does not follow: above the last outline
    window_.clear();
    for (Index x = 2; x < width_ - 2; x += 4)
        for (Index y = 2; y < Index(top_[x]) && window_.size() < window_.capacity(); y += 9)
            window_.push_back(std::abs(smooth_[x * stride_ + y]));
    if (window_.size() > 16) {
        const float sigma = std::max(1.4826F * median_of(window_), background_.sigma() / 3);
        smooth_sigma_ = has_begun_ ? 0.8F * smooth_sigma_ + 0.2F * sigma : sigma;
    } else {
        smooth_sigma_ = std::max(smooth_sigma_, background_.sigma() / 3);
    }
}

/// Into the costs: for "rows before y are background, the others tissue" the sum over rows before
/// y of the evidence for tissue.
void ContourTracker::weigh_pixels() {
    EvidenceScales scales{.sigma = std::max(smooth_sigma_, 0.4F),
                          .most = most_evidence,
                          .least = most_against,
                          .factor = temperature};
    for (Index x = 0; x < width_; ++x) {
        const float spread = std::min(tissue_sd_, most_spread * tissue_[x]);
        scales.tissue = tissue_[x];
        scales.sd = std::sqrt(scales.sigma * scales.sigma + spread * spread);
        float* evidence = &column_sum_[x * stride_];
        const float* smooth = &smooth_[x * stride_];
        pixel_evidence(smooth, scales, rows_, evidence);
        still_.hush(x, smooth, scales.sigma, evidence);
        sum_before(evidence, rows_, &search_.cost()[x * search_.stride()]);
    }
}

/// Rewards for a step of the means of five rows and for the derivative, each as a part of what the
/// tissue's edge should have, and costs of jumps.
void ContourTracker::weigh_steps() {
    for (Index x = 0; x < width_; ++x) {
        float* cost = &search_.cost()[x * search_.stride()];
        const float contrast = std::max(full_part * tissue_[x], 5 * smooth_sigma_);
        reward_steps(&residual_[x * stride_],
                     {step_reward / (contrast * float(step_rows)), step_reward,
                      derivative_reward / (0.35F * contrast), derivative_reward},
                     rows_, &column_sum_[x * stride_], cost);
        if (has_last_)
            add_jumps(last_row_[x] + last_velocity_[x] + 0.5F,
                      outline_[x].flag == PointFlag::ok ? jump_weight : guess_weight, most_jump,
                      rows_, cost);
    }
}

void ContourTracker::search() {
    weigh_pixels();
    weigh_steps();
    for (Index x = 0; x < width_; ++x)
        slope_[x] =
            shape_.is_fitted() ? slope_share * float(std::clamp(shape_.slope(x), -3.0, 3.0)) : 0;
    search_.set_bend(slope_, bend_weight, bend_curvature);
    search_.run();
    search_.margins(far_rows, margin_);
}

/// How bright the tissue is below the outline: medians over 61 columns of column means.
void ContourTracker::learn_tissue() {
    constexpr Index half = 30, step = 8, from = 3, to = 13;
    for (Index x = 0; x < width_; ++x) {
        const Index begin = visible_row(x) + from, end = std::min(visible_row(x) + to, rows_ + 1);
        float sum = 0;
        for (Index y = begin; y < end; ++y) sum += residual_[x * stride_ + y];
        tissue_new_[x] = end - begin >= 4 ? sum / float(end - begin) : -1e6F;
    }
    // Light falls off, but not to nothing: what is darker by far is background below a wrong path
    window_.clear();
    for (const float mean : tissue_new_)
        if (mean > -1e5F) window_.push_back(mean);
    const float darkest =
        std::max(3 * smooth_sigma_, window_.empty() ? 0 : darkest_part * median_of(window_));
    float last = std::max(darkest, tissue_[width_ / 2]);
    for (Index x0 = 0; x0 < width_; x0 += step) {
        window_.clear();
        for (Index x = std::max<Index>(0, x0 - half); x <= std::min(width_ - 1, x0 + half); ++x)
            if (tissue_new_[x] > -1e5F) window_.push_back(tissue_new_[x]);
        if (window_.size() >= 6) last = std::max(median_of(window_), darkest);
        for (Index x = x0; x < std::min(x0 + step, width_); ++x)
            tissue_[x] = has_begun_ ? 0.7F * tissue_[x] + 0.3F * last : last;
    }
    window_.clear();
    for (Index x = 0; x < width_; x += 3)
        for (Index y = visible_row(x) + from; y < std::min(visible_row(x) + to, rows_ + 1); y += 3)
            if (window_.size() < window_.capacity())
                window_.push_back(std::abs(smooth_[x * stride_ + y] - tissue_[x]));
    if (window_.size() < 16) return;
    const float sd = std::max(1.4826F * median_of(window_), 2.0F);
    tissue_sd_ = has_begun_ ? 0.8F * tissue_sd_ + 0.2F * sd : sd;
}

void ContourTracker::fit_edges() {
    places_.clear();
    fitted_columns_.clear();
    for (Index x = 0; x < width_; ++x) {
        const Index y = visible_row(x);
        is_good_[x] = 0;
        raw_row_[x] = float(y) - 0.5F;
        raw_sd_[x] = 3;
        step_[x] = misfit_[x] = 0;
        if (y < 5 || y > rows_ - 3) continue;
        const float* r = &residual_[x * stride_];
        Index steepest = y;
        const auto slope = [&](Index at) { return r[at + 1] + r[at] - r[at - 1] - r[at - 2]; };
        const Index left = std::max<Index>(0, x - 3), right = std::min(width_ - 1, x + 3);
        const double tilt =
            shape_.is_fitted() && has_last_
                ? shape_.slope(x)
                : double(visible_row(right) - visible_row(left)) / double(right - left);
        // a path bends at a cost: on a flank it may cut the corner by as much as it turns
        const Index reach = edge_reach + Index(std::min(std::abs(tilt), most_more_reach));
        for (Index at = std::max<Index>(2, y - reach); at <= std::min(y + reach, rows_ - 1); ++at)
            if (slope(at) > slope(steepest)) steepest = at;
        const double widened = std::sqrt(1 + std::min(tilt * tilt, 9.0));
        places_.push_back({r, steepest, float(blur_ * widened)});
        fitted_columns_.push_back(x);
    }
    edges_.resize(places_.size());
    palpate::fit_edges(places_, rows_ + 3, background_.sigma(), edges_);

    double with_width = 0, width_squares = 0;
    Index num_fitted = 0;
    for (std::size_t k = 0; k < edges_.size(); ++k) {
        const Index x = fitted_columns_[k];
        const FittedEdge& edge = edges_[k];
        is_good_[x] = 1;
        if (edge.sd > fair_sd) {  // no edge to be fitted: where the path is
            raw_sd_[x] = fair_sd;
            misfit_[x] = 1;
            step_[x] = 2 * smooth_sigma_;
            continue;
        }
        raw_row_[x] = edge.row;
        raw_sd_[x] = edge.sd;
        step_[x] = edge.step;
        // What the residuals have beyond noise, as rows: over the steepest slope of the edge
        const float noise = background_.sigma() * background_.sigma() * 2.5F;
        const float misfit = std::sqrt(std::max(0.0F, edge.variance - noise)) * places_[k].width /
                             (0.4F * std::max(4.0F, edge.step));
        // and a step that is not the tissue's: a stain's, a glare's
        const float other =
            std::abs(std::log(std::max(1.0F, edge.step) / std::max(1.0F, tissue_[x])));
        misfit_[x] =
            std::min(misfit, 2.0F) + std::clamp(other_share * (other - other_free), 0.0F, 2.0F);
        with_width += double(edge.slope_of_width);
        width_squares += double(edge.weight_of_width);
        ++num_fitted;
    }
    if (num_fitted > width_ / 8 && width_squares > 0)
        blur_ = std::clamp(
            blur_ * std::exp(std::clamp(0.5 * with_width / width_squares, -0.1, 0.1)), 0.5, 4.0);
    // Slope of the tissue's light, means of three rows eight rows apart
    double squares = 0;
    Index num_seen = 0;
    for (Index x = 0; x < width_; x += 2) {
        const Index y = visible_row(x) + 4;
        if (y + 9 >= rows_) continue;
        const float* r = &smooth_[x * stride_];
        const float change = std::clamp((r[y + 6] - r[y]) / 6, -5.0F, 5.0F);
        squares += double(change) * change;
        ++num_seen;
    }
    if (num_seen > 8) texture_ = 0.9 * texture_ + 0.1 * std::sqrt(squares / double(num_seen));
}

/// A parabola through the columns round each, weighted by 1 / sd^2: its value there.
void ContourTracker::join_columns() {
    for (Index x = 0; x < width_; ++x) per_variance_[x] = 1 / (raw_sd_[x] * raw_sd_[x] + 4e-4F);
    for (Index x = 0; x < width_; ++x) {
        joined_row_[x] = raw_row_[x];
        joined_sd_[x] = raw_sd_[x];
        if (!is_good_[x]) continue;
        const Index half = std::clamp<Index>(Index(4 + 6 * raw_sd_[x]), 4, 9);
        const double per_reach = 1 / double(half + 1);
        double s[5] = {}, v[3] = {}, squares = 0, sum_of_weights = 0, misfits = 0;
        Index count = 0;
        for (Index k = -half; k <= half; ++k) {
            const Index at = x + k;
            if (at < 0 || at >= width_ || !is_good_[at]) continue;
            if (std::abs(raw_row_[at] - raw_row_[x]) > 4 + 3 * std::abs(float(k))) continue;
            const double u = double(k) * per_reach, kernel = 1 - u * u;
            const double w = kernel * per_variance_[at];
            const double value = raw_row_[at] - raw_row_[x];
            double power = w;
            for (int n = 0; n < 5; ++n, power *= double(k)) {
                s[n] += power;
                if (n < 3) v[n] += power * value;
            }
            squares += w * value * value;
            sum_of_weights += kernel;
            misfits += kernel * misfit_[at];
            ++count;
        }
        if (count < 5) continue;
        Eigen::Matrix3d normal;
        normal << s[0], s[1], s[2], s[1], s[2], s[3], s[2], s[3], s[4];
        normal(2, 2) += 1e-6 * s[4] + 1e-12;
        const Eigen::Matrix3d inverse = normal.inverse();
        const Eigen::Vector3d right(v[0], v[1], v[2]), fitted = inverse * right;
        const double misfit = std::max(0.0, squares - fitted.dot(right));
        const double spread = misfit / std::max(1.0, sum_of_weights - 2);
        joined_row_[x] = float(raw_row_[x] + fitted[0]);
        const double texture = texture_share * texture_ * blur_ * blur_ *
                               (1 + std::pow(shape_.is_fitted() ? shape_.slope(x) : 0, 2)) /
                               std::max(4.0, double(step_[x]));
        const double misfit_of_edge = misfit_share * misfits / sum_of_weights;
        joined_sd_[x] = float(std::sqrt(inverse(0, 0) * std::max(1.0, spread) + texture * texture +
                                        misfit_of_edge * misfit_of_edge));
    }
}

void ContourTracker::judge() {
    Index first = width_, last = -1, num_good = 0;
    for (Index x = 0; x < width_; ++x) {
        const bool is_seen = visible_row(x) <= rows_ - 3;
        outline_[x] = {joined_row_[x], joined_sd_[x], is_seen ? PointFlag::ok : PointFlag::hidden};
        weight_[x] = is_seen && is_good_[x] ? 1 / (0.25F + raw_sd_[x] * raw_sd_[x]) *
                                                  (margin_[x] > least_margin ? 1.0F : 0.1F)
                                            : 0;
        if (!is_seen) continue;
        first = std::min(first, x);
        last = x;
        ++num_good;
    }
    if (num_good < 24) return;
    shape_.fit(joined_row_, weight_, first, last);
    const double far =
        std::clamp(shape_sigmas * shape_.spread(), double(least_far), double(most_far));
    for (Index x = first; x <= last; ++x) {
        if (outline_[x].flag == PointFlag::hidden) continue;
        const double away = std::abs(joined_row_[x] - shape_.row(x));
        const bool leaves =
            away > std::max(far, std::min(sd_sigmas * joined_sd_[x], far + most_more));
        if (!is_good_[x] || leaves || margin_[x] < least_margin) {
            outline_[x].flag = margin_[x] < 1 && step_[x] < 3 * smooth_sigma_ ? PointFlag::lost
                                                                              : PointFlag::guessed;
            outline_[x].sd = std::max({1.0, 0.7 * away, double(joined_sd_[x])});
            outline_[x].row = leaves ? shape_.row(x) : joined_row_[x];
        }
    }
    flag_floating({smooth_, stride_, rows_ - 3, smooth_sigma_, tissue_}, outline_);
    flag_islands(outline_);
    flag_bites(settings_.visible_rows, outline_);
}

void ContourTracker::remember() {
    background_.update(columns_, stride_, top_);
    for (Index x = 0; x < width_; ++x) {
        const float row =
            outline_[x].flag == PointFlag::hidden ? float(rows_) : float(outline_[x].row);
        last_velocity_[x] = has_last_ ? 0.5F * last_velocity_[x] +
                                            0.5F * std::clamp(row - last_row_[x], -4.0F, 4.0F)
                                      : 0;
        last_row_[x] = row;
        top_[x] =
            std::min(row, float(visible_row(x))) - (is_doubted(outline_[x].flag) ? 10.0F : 5.0F);
    }
    still_.learn(smooth_, top_);
    has_last_ = true;
}

}  // namespace palpate
