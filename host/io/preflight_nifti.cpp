// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <map>
#include <sstream>

#include "host/io/grid_check.hpp"
#include "host/io/gzip.hpp"
#include "host/io/preflight.hpp"

namespace palpate::detail {
namespace {

constexpr std::size_t header_bytes = 348;
constexpr std::size_t clean_offset = 352;

/// The fields of a NIfTI-1 header, in either byte order (nifti1.h of the NIfTI committee).
class Header {
public:
    Header(std::vector<std::uint8_t> bytes, bool swapped)
        : bytes_(std::move(bytes)), swapped_(swapped) {}

    template <typename T>
    T get(std::size_t offset) const {
        std::array<std::uint8_t, sizeof(T)> raw;
        std::copy_n(bytes_.begin() + offset, sizeof(T), raw.begin());
        if (swapped_) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }
    template <typename T>
    void put(std::size_t offset, T value) {
        auto raw = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
        if (swapped_) std::reverse(raw.begin(), raw.end());
        std::copy(raw.begin(), raw.end(), bytes_.begin() + offset);
    }
    float finite(std::size_t offset, const char* name) const {
        const float value = get<float>(offset);
        if (!std::isfinite(value)) unreadable(std::string("its header has no finite ") + name);
        return value;
    }

    int dim(int n) const { return get<std::int16_t>(40 + 2 * n); }
    int intent() const { return get<std::int16_t>(68); }
    int datatype() const { return get<std::int16_t>(70); }
    int bits_per_voxel() const { return get<std::int16_t>(72); }
    double pixdim(int n) const { return finite(76 + 4 * n, "voxel size"); }
    double voxel_offset() const { return finite(108, "data offset"); }
    double slope() const { return finite(112, "scale"); }
    double intercept() const { return finite(116, "scale"); }
    int length_unit() const { return bytes_[123] & 7; }
    int qform_code() const { return get<std::int16_t>(252); }
    int sform_code() const { return get<std::int16_t>(254); }
    double quatern(int n) const { return finite(256 + 4 * n, "orientation"); }
    double qoffset(int n) const { return finite(268 + 4 * n, "position"); }
    double srow(int row, int column) const { return finite(280 + 16 * row + 4 * column, "sform"); }
    const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    bool swapped() const { return swapped_; }

private:
    std::vector<std::uint8_t> bytes_;
    bool swapped_;
};

Header header_of(std::vector<std::uint8_t> bytes) {
    if (bytes.size() < header_bytes) unreadable("it is shorter than a NIfTI header");
    bytes.resize(header_bytes);
    for (bool swapped : {false, true}) {
        Header header(bytes, swapped);
        const auto size = header.get<std::int32_t>(0);
        if (size == 540) unreadable("it is NIfTI-2; save it as NIfTI-1");
        if (size != 348) continue;
        if (std::memcmp(&bytes[344], "ni1", 4) == 0) {
            unreadable("its voxels are in a separate .img file; save it as one .nii file");
        }
        if (std::memcmp(&bytes[344], "n+1", 4) == 0) return header;
    }
    unreadable("it is not a NIfTI file");
}

std::array<Index, 3> checked_size(const Header& header) {
    const int num_dims = header.dim(0);
    if (num_dims < 1 || num_dims > 7) unreadable("its header is damaged (number of dimensions)");
    std::vector<long long> sizes;
    for (int n = 1; n <= num_dims; ++n) sizes.push_back(header.dim(n));
    while (sizes.size() > 3 && sizes.back() == 1) sizes.pop_back();
    if (header.intent() >= 1003 && header.intent() <= 1011) {
        unusable("it holds vectors or the like (intent " + std::to_string(header.intent()) +
                 "), not one number per voxel");
    }
    checked_num_voxels(sizes);
    return {Index(sizes[0]), Index(sizes[1]), Index(sizes[2])};
}

/// Of a displacement field; ITK reads intent 1006 and 4-D fields wrongly without a word.
std::array<Index, 3> checked_vector_size(const Header& header) {
    constexpr int intent_vector = 1007;
    if (header.dim(0) != 5 || header.dim(4) != 1 || header.dim(5) != 3) {
        unusable(
            "it is no displacement field of five dimensions (x, y, z, 1, 3); save it as ITK "
            "does, with intent 1007");
    }
    if (header.intent() != intent_vector) {
        unusable("its intent is " + std::to_string(header.intent()) +
                 ", and programs differ in which way its axes point; save it with intent 1007, "
                 "LPS mm, or as an ITK transform (.h5)");
    }
    checked_num_voxels({header.dim(1), header.dim(2), header.dim(3)});
    return {Index(header.dim(1)), Index(header.dim(2)), Index(header.dim(3))};
}

std::size_t checked_voxel_bytes(const Header& header) {
    static const std::map<int, std::size_t> bytes_of{{2, 1},    {4, 2},   {8, 4},   {16, 4},
                                                     {64, 8},   {256, 1}, {512, 2}, {768, 4},
                                                     {1024, 8}, {1280, 8}};
    const auto found = bytes_of.find(header.datatype());
    if (found == bytes_of.end()) {
        unusable("its voxels are of type " + std::to_string(header.datatype()) +
                 ", not one number per voxel");
    }
    if (header.bits_per_voxel() != int(8 * found->second)) {
        unreadable("its header is damaged (bits per voxel do not fit the type)");
    }
    return found->second;
}

void check_unit(const Header& header) {
    const int unit = header.length_unit();
    if (unit != 0 && unit != 2) {
        unusable(std::string("its lengths are in ") +
                 (unit == 1   ? "metres"
                  : unit == 3 ? "micrometres"
                              : "an unknown unit") +
                 "; only mm are accepted");
    }
}

using Affine = Eigen::Matrix<double, 3, 4>;

Affine sform_of(const Header& header) {
    Affine affine;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 4; ++c) affine(r, c) = header.srow(r, c);
    return affine;
}

Affine qform_of(const Header& header) {
    Affine affine;
    const Vec3 v(header.quatern(0), header.quatern(1), header.quatern(2));
    if (v.squaredNorm() > 1 + 1e-4) unreadable("its header is damaged (orientation)");
    const Eigen::Quaterniond q(std::sqrt(std::max(0.0, 1 - v.squaredNorm())), v[0], v[1], v[2]);
    affine.leftCols<3>() = q.normalized().toRotationMatrix() *
                           Vec3(header.pixdim(1), header.pixdim(2), header.pixdim(3)).asDiagonal();
    if (header.pixdim(0) < 0) affine.col(2) *= -1;  // qfac
    for (int r = 0; r < 3; ++r) affine(r, 3) = header.qoffset(r);
    return affine;
}

/// Voxel index to RAS mm: sform where its code is set (as ITK), else qform.
Affine affine_of(const Header& header) {
    if (header.sform_code() > 0) return sform_of(header);
    if (header.qform_code() <= 0) {
        unusable("it does not say where its voxels lie (neither sform nor qform is set)");
    }
    return qform_of(header);
}

/// A sentence if both forms are set and place a corner of the volume differently.
void compare_forms(const Header& header, const ImageGrid& grid,
                   std::vector<std::string>& warnings) {
    if (header.sform_code() <= 0 || header.qform_code() <= 0) return;
    const double tolerance_mm = 0.01 * grid.spacing.minCoeff();
    const Affine change = sform_of(header) - qform_of(header);
    double most_mm = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector4d index(0, 0, 0, 1);
        for (int a = 0; a < 3; ++a)
            if (corner >> a & 1) index[a] = grid.size[a] - 1;
        most_mm = std::max(most_mm, (change * index).norm());
    }
    if (most_mm <= tolerance_mm) return;
    std::ostringstream text;
    text << "Its sform and qform place it up to " << std::setprecision(3) << most_mm
         << " mm apart; the sform was used.";
    warnings.push_back(text.str());
}

ImageGrid grid_of(const Header& header, const std::array<Index, 3>& size) {
    Affine affine = affine_of(header);
    affine.topRows<2>() *= -1;  // RAS to LPS
    ImageGrid grid;
    grid.size = size;
    grid.origin = affine.col(3);
    for (int a = 0; a < 3; ++a) {
        grid.spacing[a] = affine.col(a).norm();
        // The sform is single precision; the voxel size beside it is rounder.
        const double stated = header.pixdim(a + 1);
        if (std::abs(stated - grid.spacing[a]) < 1e-5 * grid.spacing[a]) grid.spacing[a] = stated;
        grid.direction.col(a) = affine.col(a).normalized();
    }
    return checked_grid(grid);
}

template <typename T>
void check_finite(std::span<const std::uint8_t> data, bool swapped) {
    for (std::size_t n = 0; n + sizeof(T) <= data.size(); n += sizeof(T)) {
        std::array<std::uint8_t, sizeof(T)> raw;
        std::copy_n(data.begin() + n, sizeof(T), raw.begin());
        if (swapped) std::reverse(raw.begin(), raw.end());
        if (!std::isfinite(std::bit_cast<T>(raw))) not_finite(n / sizeof(T));
    }
}

/// A header with nothing but what is needed to decode the voxels: what ITK does with orientation,
/// units, extensions and text can neither abort nor mislead.
std::vector<std::uint8_t> clean_header(const Header& original, const std::array<Index, 3>& size,
                                       unsigned components) {
    Header header(std::vector<std::uint8_t>(clean_offset, 0), original.swapped());
    header.put<std::int32_t>(0, 348);
    header.put<std::int16_t>(40, 3);
    for (int a = 0; a < 3; ++a) header.put(42 + 2 * a, static_cast<std::int16_t>(size[a]));
    for (int a = 3; a < 7; ++a) header.put<std::int16_t>(42 + 2 * a, 1);
    if (components > 1) {
        header.put<std::int16_t>(40, 5);
        header.put(50, static_cast<std::int16_t>(components));
        header.put<std::int16_t>(68, 1007);
    }
    header.put(70, static_cast<std::int16_t>(original.datatype()));
    header.put(72, static_cast<std::int16_t>(original.bits_per_voxel()));
    for (int n = 0; n < 8; ++n) header.put(76 + 4 * n, 1.0f);
    header.put(108, static_cast<float>(clean_offset));
    header.put(112, static_cast<float>(original.slope() == 0 ? 1 : original.slope()));
    header.put(116, static_cast<float>(original.slope() == 0 ? 0 : original.intercept()));
    header.put<std::int16_t>(252, 1);
    std::vector<std::uint8_t> bytes = header.bytes();
    std::memcpy(&bytes[344], "n+1", 4);
    bytes[123] = 2;  // mm
    return bytes;
}

CheckedVolume checked_volume(std::vector<std::uint8_t> bytes, unsigned components, Voxels voxels) {
    const bool compressed = is_gzip(bytes);
    const Header header = header_of(compressed ? inflated_start(bytes, header_bytes) : bytes);
    CheckedVolume volume;
    volume.format = VolumeFormat::nifti;
    volume.components = components;
    volume.size = components == 1 ? checked_size(header) : checked_vector_size(header);
    const std::size_t num_values = std::size_t(volume.size[0]) * std::size_t(volume.size[1]) *
                                   std::size_t(volume.size[2]) * components;
    const std::size_t data_bytes = num_values * checked_voxel_bytes(header);
    const double offset = header.voxel_offset();
    if (offset < 348 || offset > 1e9 || offset != std::floor(offset)) {
        unreadable("its header is damaged (data offset)");
    }
    check_unit(header);
    volume.grid = grid_of(header, volume.size);
    compare_forms(header, *volume.grid, volume.warnings);
    const std::size_t start = static_cast<std::size_t>(offset);
    if (compressed) bytes = inflated(bytes, start + data_bytes + max_trailing_bytes);
    if (bytes.size() < start) unreadable("it ends before its voxels begin; it was cut off");
    const auto data = checked_data(std::span(bytes).subspan(start), false, data_bytes);
    const bool is_used = voxels == Voxels::used;
    if (is_used && header.datatype() == 16) check_finite<float>(data, header.swapped());
    if (is_used && header.datatype() == 64) check_finite<double>(data, header.swapped());
    const std::vector<std::uint8_t> clean = clean_header(header, volume.size, components);
    volume.file = joined("volume.nii", std::string(clean.begin(), clean.end()), data);
    return volume;
}

}  // namespace

CheckedVolume preflight_nifti(std::vector<std::uint8_t> bytes, Voxels voxels) {
    return checked_volume(std::move(bytes), 1, voxels);
}

CheckedVolume preflight_nifti_vectors(std::vector<std::uint8_t> bytes) {
    return checked_volume(std::move(bytes), 3, Voxels::used);
}

}  // namespace palpate::detail
