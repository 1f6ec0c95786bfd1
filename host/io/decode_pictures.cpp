// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/decode_pictures.hpp"

#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>

#include <cmath>
#include <cstring>
#include <new>
#include <string>

#include "host/io/files.hpp"
#include "host/system/forked_work.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

constexpr double red = 0.299, green = 0.587, blue = 0.114;
constexpr std::size_t most_file_bytes = std::size_t(1) << 30;

[[noreturn]] void cannot_read(const std::string& why) {
    throw Error(ErrorCode::input_unreadable, why);
}

/// Where the child is, and what it found.
struct PictureReport {
    std::size_t at;
    GreyShape shape;
};

void refuse_unreadable(const std::filesystem::path& file) {
    if (const auto why = why_unreadable(file))
        cannot_read("cannot read the picture '" + file.string() + "': " + *why);
    if (std::filesystem::file_size(file) > most_file_bytes)
        cannot_read("cannot read the picture '" + file.string() + "': it has more than 1 GiB");
}

bool is_png(const std::filesystem::path& file) {
    const std::string ending = file.extension().string();
    return ending.size() == 4 && (ending[1] == 'p' || ending[1] == 'P');
}

/// With its header read.
itk::ImageIOBase::Pointer open_picture(const std::filesystem::path& file) {
    itk::ImageIOBase::Pointer decoder;
    if (is_png(file))
        decoder = itk::PNGImageIO::New().GetPointer();
    else
        decoder = itk::TIFFImageIO::New().GetPointer();
    if (!decoder->CanReadFile(file.c_str()))
        cannot_read(is_png(file) ? "it is no PNG file" : "it is no TIFF file");
    decoder->SetFileName(file.string());
    decoder->ReadImageInformation();
    return decoder;
}

GreyShape shape_of(const itk::ImageIOBase& decoder) {
    for (unsigned a = 2; a < decoder.GetNumberOfDimensions(); ++a)
        if (decoder.GetDimensions(a) > 1)
            cannot_read("it has " + std::to_string(decoder.GetDimensions(a)) +
                        " pages; give a file for each frame");
    if (decoder.GetNumberOfComponents() < 1 || decoder.GetNumberOfComponents() > 4)
        cannot_read("it has " + std::to_string(decoder.GetNumberOfComponents()) +
                    " numbers per pixel; allowed: grey or colours");
    const auto type = decoder.GetComponentType();
    if (type != itk::IOComponentEnum::UCHAR && type != itk::IOComponentEnum::USHORT)
        cannot_read("its numbers are not of 8 or 16 bits without sign; convert it");
    for (unsigned a = 0; a < 2; ++a)
        if (decoder.GetDimensions(a) < 1 ||
            decoder.GetDimensions(a) > itk::SizeValueType(most_pixels_a_side))
            cannot_read("it has " + std::to_string(decoder.GetDimensions(0)) + " x " +
                        std::to_string(decoder.GetDimensions(1)) + " pixels; allowed: 1 to " +
                        std::to_string(most_pixels_a_side) + " a side");
    return {Index(decoder.GetDimensions(0)), Index(decoder.GetDimensions(1)),
            type == itk::IOComponentEnum::UCHAR ? 255 : 65535};
}

template <typename T>
void take_grey(const std::byte* raw, std::size_t num_pixels, unsigned components,
               std::uint16_t* grey) {
    for (std::size_t n = 0; n < num_pixels; ++n) {
        T pixel[4];
        std::memcpy(pixel, raw + n * components * sizeof(T), components * sizeof(T));
        grey[n] =
            components < 3
                ? pixel[0]
                : std::uint16_t(std::lround(red * pixel[0] + green * pixel[1] + blue * pixel[2]));
    }
}

/// Runs in the child.
void decode_one(const std::filesystem::path& file, const GreyShape& shape, std::uint16_t* grey) {
    const itk::ImageIOBase::Pointer decoder = open_picture(file);
    const GreyShape found = shape_of(*decoder);
    if (found != shape)
        cannot_read("it has " + std::to_string(found.width) + " x " + std::to_string(found.height) +
                    " pixels up to " + std::to_string(found.largest) + ", those before " +
                    std::to_string(shape.width) + " x " + std::to_string(shape.height) + " up to " +
                    std::to_string(shape.largest) + "; give frames of one film");
    itk::ImageIORegion region(decoder->GetNumberOfDimensions());
    for (unsigned a = 0; a < decoder->GetNumberOfDimensions(); ++a) {
        region.SetIndex(a, 0);
        region.SetSize(a, decoder->GetDimensions(a));
    }
    decoder->SetIORegion(region);
    const unsigned components = decoder->GetNumberOfComponents();
    std::vector<std::byte> raw(decoder->GetImageSizeInBytes());
    if (raw.size() < shape.num_pixels() * components * decoder->GetComponentSize())
        cannot_read("the decoder gave too few pixels");
    decoder->Read(raw.data());
    if (shape.largest == 255)
        take_grey<std::uint8_t>(raw.data(), shape.num_pixels(), components, grey);
    else
        take_grey<std::uint16_t>(raw.data(), shape.num_pixels(), components, grey);
}

/// Runs `work` in a child and names the file that it was at when it failed.
void in_child(std::span<const std::filesystem::path> files, std::size_t bytes,
              const PictureReport& report, const std::function<void()>& work,
              const ProgressSink& progress) {
    check_cancelled(progress);
    ReadingLimits limits;
    limits.memory_bytes = (std::size_t(512) << 20) + bytes;
    limits.seconds = 60 + int(files.size());
    // what ITK says of a file is of no use to someone who has to mend it
    const auto guarded = [&] {
        try {
            work();
        } catch (const itk::ExceptionObject&) {
            cannot_read("it is damaged or cut");
        }
    };
    try {
        run_in_child(guarded, limits, [&] { check_cancelled(progress); });
    } catch (const Error& error) {
        if (error.code() != ErrorCode::input_unreadable) throw;
        // a damaged file must not choose its place in the list
        const std::size_t at = std::min(report.at, files.size() - 1);
        cannot_read("cannot read the picture '" + files[at].string() + "': " + error.what());
    }
}

}  // namespace

GreyShape shape_of_picture(const std::filesystem::path& file, const ProgressSink& progress) {
    refuse_unreadable(file);
    const SharedMemory memory(sizeof(PictureReport));
    auto* report = new (memory.data()) PictureReport{};
    in_child(
        {&file, 1}, 0, *report, [&] { report->shape = shape_of(*open_picture(file)); }, progress);
    return report->shape;
}

std::vector<std::uint16_t> decode_pictures(std::span<const std::filesystem::path> files,
                                           const GreyShape& shape, const ProgressSink& progress) {
    for (const auto& file : files) refuse_unreadable(file);
    const std::size_t count = files.size() * shape.num_pixels();
    const SharedMemory memory(sizeof(PictureReport) + count * sizeof(std::uint16_t));
    auto* report = new (memory.data()) PictureReport{};
    auto* grey = reinterpret_cast<std::uint16_t*>(memory.data() + sizeof(PictureReport));
    in_child(
        files, 16 * shape.num_pixels(), *report,
        [&] {
            for (std::size_t k = 0; k < files.size(); ++k) {
                report->at = k;
                decode_one(files[k], shape, grey + k * shape.num_pixels());
            }
        },
        progress);
    return {grey, grey + count};
}

}  // namespace palpate
