// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "host/apps/aspirate/contours/contour_tracker.hpp"
#include "host/apps/aspirate/contours/published_outline.hpp"
#include "host/apps/aspirate/model/aspiration_settings.hpp"

namespace palpate {

/// Finds the tissue's outline in frame after frame, in the part of them and by the method that the
/// settings name.
class OutlineFinder {
public:
    explicit OutlineFinder(const AspirationInstrument& instrument) : instrument_(instrument) {}
    OutlineFinder(const OutlineFinder&) = delete;
    OutlineFinder& operator=(const OutlineFinder&) = delete;

    /// For frames of this size. Throws Error(input_unusable) if the rim or `crop_px` is not in
    /// them.
    void begin(Index width, Index height);
    /// Valid until the next call. The first frame begins, where nobody did. Throws
    /// Error(input_unusable) for a frame of another size.
    const Outline& add(const GreyFrame& frame);
    /// The part of the last frame that was looked at; `add` of a frame that is kept whole leaves it
    /// where it was.
    const GreyFrame& seen() const { return *seen_; }

private:
    AspirationInstrument instrument_;
    Index width_ = 0, height_ = 0;
    GreyFrame part_;
    const GreyFrame* seen_ = &part_;
    std::optional<ContourTracker> ours_;
    std::optional<PublishedOutline> published_;
};

}  // namespace palpate
