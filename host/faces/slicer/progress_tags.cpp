// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/slicer/progress_tags.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

struct Share {
    const char* stage;
    double begin;  ///< of the whole run; it lasts to the next one's
};

/// As a recovery of the usual size spends its time.
constexpr std::array<Share, 9> shares{{{"reading", 0},
                                       {"surfaces", 0.05},
                                       {"aligning", 0.15},
                                       {"meshing", 0.2},
                                       {"condensing", 0.4},
                                       {"searching", 0.6},
                                       {"volumes", 0.8},
                                       {"writing", 0.9},
                                       {"", 1}}};

std::string without_markup(const std::string& text) {
    std::string plain;
    for (const char c : text) {
        if (c == '<')
            plain += "&lt;";
        else if (c == '>')
            plain += "&gt;";
        else if (c == '&')
            plain += "&amp;";
        else
            plain += c == '\n' ? ' ' : c;
    }
    return plain;
}

}  // namespace

void ProgressTags::print(const std::string& line) {
    fmt::print(out_, "{}\n", line);
    std::fflush(out_);
}

void ProgressTags::start(const std::string& name, const std::string& comment) {
    name_ = name;
    started_ = std::chrono::steady_clock::now();
    print(
        fmt::format("<filter-start><filter-name>{}</filter-name><filter-comment>{}"
                    "</filter-comment></filter-start>",
                    name, without_markup(comment)));
}

void ProgressTags::advance(double fraction) {
    fraction_ = std::max(fraction_, std::min(fraction, 1.0));
    print(fmt::format("<filter-progress>{:.4f}</filter-progress>", fraction_));
}

void ProgressTags::tell(const Progress& progress) {
    if (progress.stage.empty()) return;  // no news
    if (progress.stage != stage_) {
        stage_ = progress.stage;
        for (std::size_t k = 0; k + 1 < shares.size(); ++k)
            if (stage_ == shares[k].stage) {
                begin_ = shares[k].begin;
                end_ = shares[k + 1].begin;
            }
        if (!progress.message.empty())
            print(without_markup(fmt::format("{}: {}", stage_, progress.message)));
    }
    advance(begin_ + std::clamp(progress.fraction, 0.0, 1.0) * (end_ - begin_));
}

void ProgressTags::end() {
    advance(1);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - started_;
    print(
        fmt::format("<filter-end><filter-name>{}</filter-name><filter-time>{:.3f}</filter-time>"
                    "</filter-end>",
                    name_, seconds.count()));
}

}  // namespace palpate
