// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace palpate::testing {

using Bytes = std::vector<std::uint8_t>;

/// A folder for the files of one test, removed at its end.
class ScratchFolder {
public:
    ScratchFolder() {
        std::string name =
            (std::filesystem::temp_directory_path() / "palpate-test-XXXXXX").string();
        path_ = mkdtemp(name.data());
    }
    ~ScratchFolder() { std::filesystem::remove_all(path_); }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

inline void save(const std::filesystem::path& path, const Bytes& bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
}
inline void save(const std::filesystem::path& path, const std::string& text) {
    save(path, Bytes(text.begin(), text.end()));
}
inline Bytes load_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(in), {});
}

template <typename T>
void put(Bytes& bytes, std::size_t offset, T value) {
    std::memcpy(&bytes.at(offset), &value, sizeof(T));
}
template <typename T>
T get(const Bytes& bytes, std::size_t offset) {
    T value;
    std::memcpy(&value, &bytes.at(offset), sizeof(T));
    return value;
}

inline Bytes gzipped(const Bytes& bytes) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
    Bytes out(deflateBound(&stream, bytes.size()) + 64);
    stream.next_in = const_cast<Bytef*>(bytes.data());
    stream.avail_in = uInt(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = uInt(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

inline Bytes gunzipped(const Bytes& bytes, std::size_t most) {
    z_stream stream{};
    inflateInit2(&stream, 15 + 32);
    Bytes out(most);
    stream.next_in = const_cast<Bytef*>(bytes.data());
    stream.avail_in = uInt(bytes.size());
    stream.next_out = out.data();
    stream.avail_out = uInt(most);
    inflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    inflateEnd(&stream);
    return out;
}

/// A sound NIfTI-1 file written by hand: 4 x 3 x 2 voxels of uint8 with the values 0..23, spacing
/// 2 x 3 x 4 mm, RAS origin (10, -20, 30), axes along R, A, S; sform and qform agree.
inline Bytes good_nifti() {
    Bytes b(352 + 24, 0);
    put<std::int32_t>(b, 0, 348);
    const std::int16_t dim[8] = {3, 4, 3, 2, 1, 1, 1, 1};
    for (int n = 0; n < 8; ++n) put(b, 40 + 2 * n, dim[n]);
    put<std::int16_t>(b, 70, 2);
    put<std::int16_t>(b, 72, 8);
    const float pixdim[4] = {1, 2, 3, 4};
    for (int n = 0; n < 4; ++n) put(b, 76 + 4 * n, pixdim[n]);
    put(b, 108, 352.0f);
    put(b, 112, 1.0f);
    b[123] = 2;
    put<std::int16_t>(b, 252, 1);
    put<std::int16_t>(b, 254, 1);
    const float offset[3] = {10, -20, 30};
    for (int r = 0; r < 3; ++r) {
        put(b, 268 + 4 * r, offset[r]);
        put(b, 280 + 16 * r + 4 * r, pixdim[r + 1]);
        put(b, 280 + 16 * r + 12, offset[r]);
    }
    std::memcpy(&b[344], "n+1", 4);
    for (int n = 0; n < 24; ++n) b[352 + n] = std::uint8_t(n);
    return b;
}

}  // namespace palpate::testing
