// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "solver/base/error.hpp"
#include "solver/base/types.hpp"

namespace palpate {

using FileMark = std::array<char, 8>;  ///< with which a file says what it is

/// Values that are stored as the bytes they have in memory.
template <typename T>
concept PlainValue = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, Vec3> ||
    std::is_same_v<T, Mat3> || std::is_same_v<T, Triangle> || std::is_same_v<T, Tet> ||
    std::is_same_v<T, std::array<Index, 2>> || std::is_same_v<T, std::array<double, 2>> ||
    std::is_same_v<T, FileMark>;

/// FNV-1a, 64 bits: any change of a single byte changes it.
inline std::uint64_t content_hash(std::span<const char> bytes) {
    std::uint64_t hash = 14695981039346656037u;
    for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211u;
    return hash;
}

/// Values to bytes, in the byte order of this machine. Lists are their length (64 bits) and their
/// values, matrices their rows and columns and their values column by column.
class ByteWriter {
public:
    template <typename... Values>
    void operator()(const Values&... values) {
        (put(values), ...);
    }
    /// A list of compound values: its length and what `visit(writer, item)` writes of each.
    template <typename T, typename Visit>
    void each(std::vector<T>& items, const Visit& visit) {
        put(std::uint64_t{items.size()});
        for (T& item : items) visit(*this, item);
    }
    template <typename T, typename Visit>
    void each(const std::vector<T>& items, const Visit& visit) {
        put(std::uint64_t{items.size()});
        for (const T& item : items) visit(*this, item);
    }
    const std::string& bytes() const { return bytes_; }

private:
    void append(const void* data, std::size_t size) {
        bytes_.append(static_cast<const char*>(data), size);
    }
    template <PlainValue T>
    void put(const T& value) {
        append(&value, sizeof(T));
    }
    void put(const std::string& text) {
        put(std::uint64_t{text.size()});
        append(text.data(), text.size());
    }
    template <PlainValue T>
    void put(const std::vector<T>& values) {
        put(std::uint64_t{values.size()});
        append(values.data(), values.size() * sizeof(T));
    }
    template <int columns>
    void put(const Eigen::Matrix<double, Eigen::Dynamic, columns>& matrix) {
        put(std::int64_t{matrix.rows()});
        put(std::int64_t{matrix.cols()});
        append(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
    }

    std::string bytes_;
};

/// Reads what ByteWriter wrote. Every length is checked against the bytes that are left before
/// anything is allocated. Throws Error(input_unreadable) where they do not suffice.
class ByteReader {
public:
    /// `bytes` must outlive this object.
    explicit ByteReader(std::span<const char> bytes) : bytes_(bytes) {}

    template <typename... Values>
    void operator()(Values&... values) {
        (get(values), ...);
    }
    template <typename T, typename Visit>
    void each(std::vector<T>& items, const Visit& visit) {
        const std::size_t count = length(1);
        items.clear();
        for (std::size_t k = 0; k < count; ++k) visit(*this, items.emplace_back());
    }
    bool at_end() const { return bytes_.empty(); }

private:
    static void require(bool good) {
        if (!good) throw Error(ErrorCode::input_unreadable, "a length in it is not possible");
    }
    void take(void* data, std::size_t size) {
        require(size <= bytes_.size());
        if (size > 0) std::memcpy(data, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }
    /// A number of values of at least `size` bytes each.
    std::size_t length(std::size_t size) {
        std::uint64_t count = 0;
        get(count);
        require(count <= bytes_.size() / size);
        return static_cast<std::size_t>(count);
    }
    template <PlainValue T>
    void get(T& value) {
        take(static_cast<void*>(&value), sizeof(T));
    }
    void get(std::string& text) {
        text.resize(length(1));
        take(text.data(), text.size());
    }
    template <PlainValue T>
    void get(std::vector<T>& values) {
        values.resize(length(sizeof(T)));
        take(static_cast<void*>(values.data()), values.size() * sizeof(T));
    }
    template <int columns>
    void get(Eigen::Matrix<double, Eigen::Dynamic, columns>& matrix) {
        constexpr std::int64_t most = 1 << 30;
        std::int64_t rows = 0, cols = 0;
        get(rows);
        get(cols);
        require(rows >= 0 && cols >= 0 && rows <= most && cols <= most);
        require(columns == Eigen::Dynamic || cols == columns);
        const auto left = static_cast<std::int64_t>(bytes_.size() / sizeof(double));
        require(cols == 0 || rows <= left / cols);
        matrix.resize(rows, cols);
        take(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
    }

    std::span<const char> bytes_;
};

}  // namespace palpate
