// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "host/apps/aspirate/contours/background_field.hpp"
#include "host/apps/aspirate/contours/edge_fit.hpp"
#include "host/apps/aspirate/contours/outline.hpp"
#include "host/apps/aspirate/contours/outline_search.hpp"
#include "host/apps/aspirate/contours/outline_shape.hpp"
#include "host/apps/aspirate/contours/still_things.hpp"

namespace palpate {

/// Finds the tissue's outline in frame after frame of a film. Memory is kept from frame to frame.
///
/// Each pixel, averaged with its eight neighbours, says how much rather it is tissue than
/// background: glare and blood are not background, what stands still while the tissue moves
/// (bubbles) says nothing. The outline is the path from left to right that cuts best between both,
/// with bounded rewards for a step of brightness, and costs for bends and for jumps from the frame
/// before (`OutlineSearch`); then an edge under a known blur is fitted in each column, and a local
/// parabola through the columns. A point is flagged where another path is nearly as good, or the
/// outline leaves its own smooth shape.
class ContourTracker {
public:
    explicit ContourTracker(const ContourSettings& settings);

    /// The outline in the next frame; valid until the next call. Throws Error(input_unusable) for a
    /// frame of another size.
    const Outline& add(const GreyFrame& frame);

    /// Of the optical blur, as the frames so far show it, pixels.
    double blur() const { return blur_; }

private:
    void load(const GreyFrame& frame);
    void begin();
    void smooth_residuals();
    void weigh_pixels();
    void weigh_steps();
    void search();
    void learn_tissue();
    void fit_edges();
    void join_columns();
    void judge();
    void remember();
    Index visible_row(Index x) const { return search_.path()[x]; }

    ContourSettings settings_;
    Index width_, rows_, stride_;  ///< rows that are searched
    bool has_begun_ = false, has_last_ = false;
    BackgroundField background_;
    OutlineSearch search_;
    OutlineShape shape_;
    StillThings still_;
    std::vector<float> columns_, residual_, smooth_, column_sum_;  ///< [width][stride]
    std::vector<float> tissue_, tissue_new_, window_, slope_;
    float tissue_sd_ = 20, smooth_sigma_ = 1;
    double blur_ = 1.1, texture_ = 1;
    std::vector<float> top_, raw_row_, raw_sd_, joined_row_, joined_sd_, margin_, weight_, step_,
        misfit_, per_variance_, last_row_, last_velocity_;
    std::vector<char> is_good_;
    std::vector<EdgePlace> places_;  ///< of the columns fitted_columns_
    std::vector<FittedEdge> edges_;
    std::vector<Index> fitted_columns_;
    Outline outline_;
};

}  // namespace palpate
