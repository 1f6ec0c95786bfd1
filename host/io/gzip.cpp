// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/io/gzip.hpp"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "solver/base/error.hpp"

namespace palpate {
namespace {

[[noreturn]] void fail(const char* reason) { throw Error(ErrorCode::input_unreadable, reason); }

class Inflater {
public:
    explicit Inflater(std::span<const std::uint8_t> bytes) : all_(bytes), left_(bytes) {
        constexpr int gzip_or_zlib = 15 + 32;
        if (inflateInit2(&stream_, gzip_or_zlib) != Z_OK) fail("the decompressor did not start");
    }
    ~Inflater() { inflateEnd(&stream_); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;

    /// Appends the next piece; false at the end of the last member, whose checksum zlib has
    /// compared.
    bool next(std::vector<std::uint8_t>& out) {
        if (stream_.avail_in == 0 && !left_.empty()) {
            const std::size_t count = std::min<std::size_t>(left_.size(), 1u << 30);
            stream_.next_in = const_cast<Bytef*>(left_.data());
            stream_.avail_in = static_cast<uInt>(count);
            left_ = left_.subspan(count);
        }
        std::array<std::uint8_t, 1 << 16> piece;
        stream_.next_out = piece.data();
        stream_.avail_out = piece.size();
        const int status = inflate(&stream_, Z_NO_FLUSH);
        if (status == Z_BUF_ERROR) fail("its compressed data are cut off");
        if (status != Z_OK && status != Z_STREAM_END) {
            fail("its compressed data are damaged (checksum or content)");
        }
        out.insert(out.end(), piece.begin(), piece.end() - stream_.avail_out);
        return status != Z_STREAM_END || another_member();
    }

private:
    bool another_member() {
        const auto rest = all_.last(stream_.avail_in + left_.size());
        if (std::all_of(rest.begin(), rest.end(), [](std::uint8_t b) { return b == 0; })) {
            return false;
        }
        if (!is_gzip(rest)) fail("its compressed data are followed by something else");
        inflateReset(&stream_);
        return true;
    }

    z_stream stream_{};
    std::span<const std::uint8_t> all_, left_;
};

}  // namespace

bool is_gzip(std::span<const std::uint8_t> bytes) {
    return bytes.size() > 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

std::vector<std::uint8_t> inflated_start(std::span<const std::uint8_t> bytes, std::size_t count) {
    Inflater inflater(bytes);
    std::vector<std::uint8_t> out;
    while (out.size() < count && inflater.next(out)) {
    }
    out.resize(std::min(out.size(), count));
    return out;
}

std::vector<std::uint8_t> inflated(std::span<const std::uint8_t> bytes, std::size_t most) {
    Inflater inflater(bytes);
    std::vector<std::uint8_t> out;
    while (inflater.next(out)) {
        if (out.size() > most) fail("it holds more data than its header announces");
    }
    if (out.size() > most) fail("it holds more data than its header announces");
    return out;
}

std::vector<std::uint8_t> gzipped(std::span<const std::uint8_t> bytes) {
    constexpr int quickest = 1;
    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
        libdeflate_alloc_compressor(quickest), libdeflate_free_compressor);
    if (!compressor) throw std::bad_alloc();
    const std::size_t most = libdeflate_gzip_compress_bound(compressor.get(), bytes.size());
    const auto out = std::make_unique_for_overwrite<std::uint8_t[]>(most);
    const std::size_t size =
        libdeflate_gzip_compress(compressor.get(), bytes.data(), bytes.size(), out.get(), most);
    return {out.get(), out.get() + size};
}

}  // namespace palpate
