// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <sstream>
#include <vector>

#include "host/apps/aspirate/frames/frame_reader.hpp"
#include "host/io/decode_pictures.hpp"
#include "host/io/files.hpp"
#include "host/system/child_process.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr double decoder_gib = 4, silent_limit_s = 60;
constexpr int film_tick_ms = 100;
constexpr std::size_t longest_header = 1000, longest_line = 4000;

fs::path find_ffmpeg() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const fs::path program = fs::path(folder) / "ffmpeg";
        if (fs::path(folder).is_absolute() && ::access(program.c_str(), X_OK) == 0) return program;
    }
    throw Error(ErrorCode::invalid_argument,
                "films are read by the program ffmpeg, which is not in PATH; install it, or give a "
                "folder of .png files");
}

/// What `showinfo` says of a frame.
struct FilmFrameInfo {
    double time_s = 0;
    std::string format;  ///< "yuv420p 180x180"
};

/// The word behind `key` in a line; empty if it is not there.
std::string word_behind(const std::string& line, const std::string& key) {
    const std::size_t at = line.find(key);
    if (at == std::string::npos) return "";
    std::istringstream rest(line.substr(at + key.size(), 100));
    std::string word;
    rest >> word;
    return word;
}

/// Grey frames in the format YUV4MPEG2 on the output of ffmpeg, and what its filter `showinfo` says
/// of each before it is converted.
class FilmFrames final : public FrameReader {
public:
    FilmFrames(const fs::path& file, ProgressSink progress)
        : name_(file.string()),
          progress_(std::move(progress)),
          child_(find_ffmpeg(),
                 {"-nostdin",
                  "-hide_banner",
                  "-nostats",
                  "-loglevel",
                  "level+info",
                  "-xerror",
                  "-threads",
                  "1",
                  "-protocol_whitelist",
                  "file",
                  "-i",
                  "file:" + fs::absolute(file).string(),
                  "-map",
                  "0:v:0",
                  "-vf",
                  "showinfo",
                  "-fps_mode",
                  "passthrough",
                  "-pix_fmt",
                  "gray",
                  "-f",
                  "yuv4mpegpipe",
                  "-"},
                 {0, decoder_gib}) {}

    bool next(GreyFrame& frame) override {
        if (number_ == 0 && !read_header()) refuse_end("it has no pictures");
        std::string line;
        if (!take_line(line)) {
            finish();
            return false;
        }
        if (line.rfind("FRAME", 0) != 0) cannot_read_film("ffmpeg sent no frame");
        const std::size_t count = std::size_t(width_) * std::size_t(height_);
        while (output_.size() < at_ + count)
            if (!wait()) refuse_end("its last frame is cut");
        while (infos_.empty())
            if (!wait()) refuse_end("ffmpeg did not say when a frame was taken");
        frame.width = width_;
        frame.height = height_;
        frame.grey.resize(count);
        for (std::size_t n = 0; n < count; ++n)
            frame.grey[n] = float(static_cast<unsigned char>(output_[at_ + n]));
        at_ += count;
        take_info();
        ++number_;
        return true;
    }
    std::optional<double> time_s() const override { return time_s_; }

private:
    [[noreturn]] void cannot_read_film(const std::string& why) const {
        throw Error(
            ErrorCode::input_unreadable,
            fmt::format("cannot read the film '{}', frame {}: {}", name_, number_ + 1, why));
    }
    /// The film ended where it should not: what ffmpeg said of it, if it said something.
    [[noreturn]] void refuse_end(const std::string& why) {
        while (wait()) {
            output_.clear();
            at_ = 0;
        }
        cannot_read_film(complaint_.empty() ? why : complaint_);
    }

    /// More of either output; false at the end of both.
    bool wait() {
        if (child_.output().descriptor() < 0 && child_.errors().descriptor() < 0) return false;
        const auto begin = std::chrono::steady_clock::now();
        for (;;) {
            check_cancelled(progress_);
            std::array<pollfd, 2> ends{pollfd{child_.output().descriptor(), POLLIN, 0},
                                       pollfd{child_.errors().descriptor(), POLLIN, 0}};
            if (::poll(ends.data(), ends.size(), film_tick_ms) > 0) {
                if (ends[0].revents) take_output();
                if (ends[1].revents) take_errors();
                return true;
            }
            const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
            if (waited.count() > silent_limit_s) cannot_read_film("ffmpeg takes too long");
        }
    }

    void take_output() {
        output_.erase(0, at_);
        at_ = 0;
        std::string more;
        child_.output().drain(more);
        output_ += more;
    }

    void take_errors() {
        child_.errors().drain(errors_);
        std::size_t end = 0;
        while ((end = errors_.find('\n')) != std::string::npos) {
            take_message(errors_.substr(0, end));
            errors_.erase(0, end + 1);
        }
        if (errors_.size() > longest_line) errors_.clear();
    }

    void take_message(const std::string& line) {
        const std::string time = word_behind(line, " pts_time:");
        if (!time.empty()) {
            const std::string format = word_behind(line, " fmt:") + " " + word_behind(line, " s:");
            infos_.push_back({std::atof(time.c_str()), format});
            return;
        }
        if (line.find("[yuv4mpeg") != std::string::npos) return;  // of what is written, not read
        for (const char* level : {"[error] ", "[fatal] "})
            if (const std::size_t at = line.find(level); at != std::string::npos)
                complaint_ = line.substr(at + 8, 200);
    }

    /// A line of the output, which must be short; false at the end.
    bool take_line(std::string& line) {
        std::size_t end = 0;
        while ((end = output_.find('\n', at_)) == std::string::npos) {
            if (output_.size() - at_ > longest_header) cannot_read_film("ffmpeg sent no frame");
            if (!wait()) return false;
        }
        line = output_.substr(at_, end - at_);
        at_ = end + 1;
        return true;
    }

    bool read_header() {
        std::string line;
        if (!take_line(line)) return false;
        width_ = Index(std::atoi(word_behind(line, " W").c_str()));
        height_ = Index(std::atoi(word_behind(line, " H").c_str()));
        if (line.rfind("YUV4MPEG2", 0) != 0 || word_behind(line, " C") != "mono")
            cannot_read_film("ffmpeg sent no grey film");
        if (width_ < 1 || height_ < 1 || width_ > most_pixels_a_side ||
            height_ > most_pixels_a_side)
            cannot_read_film(fmt::format("it has {} x {} pixels; allowed: 1 to {} a side", width_,
                                         height_, most_pixels_a_side));
        return true;
    }

    void take_info() {
        const FilmFrameInfo info = infos_.front();
        infos_.pop_front();
        if (number_ == 0) format_ = info.format;
        if (info.format != format_)
            cannot_read_film(
                fmt::format("its pictures change from {} to {}; give frames of one "
                            "film",
                            format_, info.format));
        time_s_ = info.time_s;
    }

    void finish() {
        while (wait()) {
        }
        std::optional<ChildEnd> end;
        while (!(end = child_.ended())) ::usleep(1000);
        if (at_ < output_.size()) cannot_read_film("its last frame is cut");
        // ffmpeg repairs what it can and goes on: its complaint is all that tells
        if (!complaint_.empty() || end->exit_code != 0)
            cannot_read_film(complaint_.empty() ? "ffmpeg failed" : complaint_);
    }

    std::string name_;
    ProgressSink progress_;
    ChildProcess child_;
    std::string output_, errors_, complaint_, format_;
    std::size_t at_ = 0;  ///< of `output_`, where what was not taken yet begins
    Index width_ = 0, height_ = 0, number_ = 0;
    std::deque<FilmFrameInfo> infos_;
    std::optional<double> time_s_;
};

}  // namespace

bool is_film_name(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    constexpr std::array endings{".avi", ".mp4", ".m4v", ".mov", ".mkv", ".webm", ".mpg", ".wmv"};
    std::error_code ignored;
    return std::find(endings.begin(), endings.end(), ending) != endings.end() &&
           !fs::is_directory(file, ignored);
}

std::unique_ptr<FrameReader> read_film(const fs::path& file, const ProgressSink& progress) {
    if (const auto why = why_unreadable(file))
        throw Error(ErrorCode::input_unreadable,
                    fmt::format("cannot read the film '{}': {}", file.string(), *why));
    return std::make_unique<FilmFrames>(file, progress);
}

}  // namespace palpate
