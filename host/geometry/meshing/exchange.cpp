// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/meshing/exchange.hpp"

#include <bit>
#include <cstring>
#include <fstream>

#include "solver/base/error.hpp"

namespace palpate {

namespace {

static_assert(std::endian::native == std::endian::little, "the exchange file is little-endian");

constexpr char magic[8] = {'P', 'A', 'L', 'P', 'E', 'X', 'C', '1'};
constexpr std::size_t name_size = 32;
constexpr std::uint64_t max_arrays = 64;
constexpr std::uint32_t max_columns = 16;

struct Header {
    char name[name_size];
    std::uint32_t type;
    std::uint32_t columns;
    std::uint64_t rows;
};
static_assert(sizeof(Header) == 48);

[[noreturn]] void unreadable(const std::string& why) {
    throw Error(ErrorCode::input_unreadable, "the exchange file of the mesher " + why);
}

Exchange::Values empty_values(std::uint32_t type) {
    switch (type) {
        case 0:
            return std::vector<std::uint8_t>{};
        case 1:
            return std::vector<std::int32_t>{};
        case 2:
            return std::vector<float>{};
        case 3:
            return std::vector<double>{};
        default:
            unreadable("holds an unknown type");
    }
}

std::string checked_name(const Header& header) {
    const std::size_t length = strnlen(header.name, name_size);
    if (length == 0 || length == name_size) unreadable("holds an array without a proper name");
    return {header.name, length};
}

/// Reads from a stream whose remaining bytes are known, so that no size field can ask for more.
class Reader {
public:
    explicit Reader(const std::filesystem::path& path) : file_(path, std::ios::binary) {
        std::error_code error;
        left_ = std::filesystem::file_size(path, error);
        if (error || !file_) unreadable("cannot be opened: " + path.string());
    }
    void read(void* to, std::uint64_t bytes) {
        if (bytes > left_) unreadable("is cut off");
        if (bytes == 0) return;
        if (!file_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes)))
            unreadable("cannot be read");
        left_ -= bytes;
    }
    std::uint64_t left() const { return left_; }

private:
    std::ifstream file_;
    std::uint64_t left_ = 0;
};

void read_values(Reader& reader, const Header& header, Exchange::Values& values) {
    std::visit(
        [&](auto& v) {
            const std::uint64_t row_bytes = header.columns * sizeof(v[0]);
            if (header.rows > reader.left() / row_bytes) unreadable("is cut off");
            v.resize(header.rows * header.columns);
            reader.read(v.data(), header.rows * row_bytes);
        },
        values);
}

}  // namespace

void Exchange::throw_missing(const std::string& name, std::uint32_t columns) {
    unreadable("has no array '" + name + "' of the right type with " + std::to_string(columns) +
               " columns");
}

void Exchange::set(const std::string& name, Values values, std::uint32_t columns) {
    const std::size_t size = std::visit([](const auto& v) { return v.size(); }, values);
    if (name.empty() || name.size() >= name_size || columns == 0 || columns > max_columns ||
        size % columns != 0)
        throw Error(ErrorCode::internal, "array '" + name + "' does not fit the exchange file");
    arrays_[name] = Array{columns, std::move(values)};
}

void Exchange::set_points(const std::string& name, const std::vector<Vec3>& points) {
    std::vector<double> values;
    values.reserve(points.size() * 3);
    for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
    set(name, std::move(values), 3);
}

void Exchange::set_text(const std::string& name, const std::string& text) {
    set(name, std::vector<std::uint8_t>(text.begin(), text.end()));
}

std::vector<Vec3> Exchange::points(const std::string& name) const {
    const auto& values = get<double>(name, 3);
    std::vector<Vec3> points(values.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = Vec3::Map(values.data() + 3 * i);
    return points;
}

std::string Exchange::text(const std::string& name) const {
    const auto& bytes = get<std::uint8_t>(name);
    return {bytes.begin(), bytes.end()};
}

void Exchange::write(const std::filesystem::path& path) const {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    const std::uint64_t count = arrays_.size();
    file.write(magic, sizeof magic);
    file.write(reinterpret_cast<const char*>(&count), sizeof count);
    for (const auto& [name, array] : arrays_) {
        Header header{};
        std::memcpy(header.name, name.data(), name.size());
        header.type = static_cast<std::uint32_t>(array.values.index());
        header.columns = array.columns;
        std::visit(
            [&](const auto& v) {
                header.rows = v.size() / header.columns;
                file.write(reinterpret_cast<const char*>(&header), sizeof header);
                file.write(reinterpret_cast<const char*>(v.data()),
                           static_cast<std::streamsize>(v.size() * sizeof(v[0])));
            },
            array.values);
    }
    file.close();
    if (!file)
        throw Error(ErrorCode::output_failed,
                    "cannot write '" + path.string() + "': is the disk of temporary files full?");
}

Exchange Exchange::read(const std::filesystem::path& path) {
    Reader reader(path);
    char start[sizeof magic];
    std::uint64_t count = 0;
    reader.read(start, sizeof start);
    if (std::memcmp(start, magic, sizeof magic) != 0) unreadable("does not start as one");
    reader.read(&count, sizeof count);
    if (count > max_arrays) unreadable("claims too many arrays");
    Exchange result;
    for (std::uint64_t i = 0; i < count; ++i) {
        Header header{};
        reader.read(&header, sizeof header);
        const std::string name = checked_name(header);
        if (header.columns == 0 || header.columns > max_columns)
            unreadable("holds an array with a bad number of columns");
        if (result.has(name)) unreadable("holds an array twice");
        Array array{header.columns, empty_values(header.type)};
        read_values(reader, header, array.values);
        result.arrays_.emplace(name, std::move(array));
    }
    if (reader.left() != 0) unreadable("has bytes after its end");
    return result;
}

}  // namespace palpate
