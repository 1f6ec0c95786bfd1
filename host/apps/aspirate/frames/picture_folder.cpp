// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "host/apps/aspirate/frames/frame_reader.hpp"
#include "host/apps/aspirate/frames/pgm_picture.hpp"
#include "host/io/decode_pictures.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t batch_pixels = std::size_t(4) << 20, most_in_batch = 64;

[[noreturn]] void refuse_picture(const std::string& why) {
    throw Error(ErrorCode::input_unreadable, why);
}

/// "pgm", "png" or "tif"; empty for other files.
std::string picture_kind(const fs::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (ending == ".tiff") return "tif";
    return ending == ".pgm" || ending == ".png" || ending == ".tif" ? ending.substr(1) : "";
}

std::vector<fs::path> pictures_in(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(folder, failed))
        if (!picture_kind(entry.path()).empty()) files.push_back(entry.path());
    if (failed || files.empty())
        refuse_picture(
            fmt::format("'{}' is no folder with frames; give a folder of .pgm, .png or .tif files, "
                        "a film (.avi, .mp4), or - and --raw for bytes on standard input",
                        folder.string()));
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files)
        if (picture_kind(file) != picture_kind(files.front()))
            refuse_picture(fmt::format(
                "'{}' has pictures of two kinds, '{}' and '{}'; give those of one "
                "film",
                folder.string(), files.front().filename().string(), file.filename().string()));
    return files;
}

/// A child for each picture would take most of the time: some are decoded at once.
class PictureFolder final : public FrameReader {
public:
    PictureFolder(const fs::path& folder, ProgressSink progress)
        : files_(pictures_in(folder)),
          progress_(std::move(progress)),
          is_pgm_(picture_kind(files_.front()) == "pgm") {}

    bool next(GreyFrame& frame) override {
        if (number_ == files_.size()) return false;
        if (is_pgm_)
            read_pgm(files_[number_], frame);
        else
            take_decoded(frame);
        ++number_;
        return true;
    }
    Index num_frames() const override { return Index(files_.size()); }

private:
    void read_pgm(const fs::path& file, GreyFrame& frame) {
        const std::string name = "the frame '" + file.string() + "'";
        if (const auto why = why_unreadable(file))
            refuse_picture(fmt::format("cannot read {}: {}", name, *why));
        std::ifstream in(file, std::ios::binary);
        bytes_.assign(std::istreambuf_iterator<char>(in), {});
        GreyShape found;
        try {
            frame = parse_pgm(bytes_, found.largest);
        } catch (const Error& error) {
            refuse_picture(fmt::format("cannot read {}: {}", name, error.what()));
        }
        found.width = frame.width;
        found.height = frame.height;
        if (number_ == 0) shape_ = found;
        if (found != shape_)
            refuse_picture(
                fmt::format("{} has {} x {} pixels up to {}, those before {} x {} up to {}; give "
                            "frames of one film",
                            name, found.width, found.height, found.largest, shape_.width,
                            shape_.height, shape_.largest));
    }

    void take_decoded(GreyFrame& frame) {
        if (number_ == 0) shape_ = shape_of_picture(files_.front(), progress_);
        if (number_ == batch_end_) {
            const std::size_t most =
                std::clamp(batch_pixels / shape_.num_pixels(), std::size_t(1), most_in_batch);
            batch_begin_ = batch_end_;
            batch_end_ = std::min(files_.size(), batch_begin_ + most);
            batch_ =
                decode_pictures(std::span(files_).subspan(batch_begin_, batch_end_ - batch_begin_),
                                shape_, progress_);
        }
        frame.width = shape_.width;
        frame.height = shape_.height;
        frame.grey.resize(shape_.num_pixels());
        const std::uint16_t* grey = &batch_[(number_ - batch_begin_) * shape_.num_pixels()];
        const float white = 255.0F / float(shape_.largest);
        for (std::size_t n = 0; n < frame.grey.size(); ++n) frame.grey[n] = white * float(grey[n]);
    }

    std::vector<fs::path> files_;
    ProgressSink progress_;
    bool is_pgm_;
    std::size_t number_ = 0, batch_begin_ = 0, batch_end_ = 0;
    GreyShape shape_;
    std::vector<char> bytes_;
    std::vector<std::uint16_t> batch_;
};

}  // namespace

std::unique_ptr<FrameReader> read_picture_folder(const fs::path& folder,
                                                 const ProgressSink& progress) {
    return std::make_unique<PictureFolder>(folder, progress);
}

}  // namespace palpate
