// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/saved_reference_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <utility>

#include "host/apps/recover/pipeline/stored_parts.hpp"
#include "host/io/files.hpp"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr FileMark file_mark{'P', 'A', 'L', 'P', 'R', 'E', 'D', '\n'};

struct Header {
    FileMark mark = file_mark;
    std::uint32_t byte_order = 0x01020304;
    std::uint32_t format = 3;  ///< count up whenever the content changes
    std::uint64_t content_bytes = 0;
    std::uint64_t content_hash = 0;
};
constexpr std::size_t header_bytes = 32;

template <typename Stream>
void visit(Stream& stream, Header& header) {
    stream(header.mark, header.byte_order, header.format, header.content_bytes,
           header.content_hash);
}

template <typename Stream>
void visit(Stream& stream, ReferenceFingerprint& made_from) {
    ImageGrid& grid = made_from.grid;
    stream(made_from.version, made_from.settings_toml, grid.size, grid.origin, grid.spacing,
           grid.direction, made_from.voxels_hash);
}

template <typename Stream>
void visit(Stream& stream, ResponseModel::Parts& parts) {
    stream.each(parts.regions, [](auto& inner, ResponseModel::Region& region) {
        inner(region.region, region.stiffness, region.coupling);
    });
    stream(parts.stiffness_kpa, parts.modes, parts.functionals, parts.spread,
           parts.prior_covariance, parts.influence, parts.root_tolerance, parts.left_out_mm);
}

template <typename Stream>
void visit(Stream& stream, CondensationSummary& summary) {
    LinearSolverInfo& solver = summary.solver;
    stream(summary.columns, summary.seconds, solver.method, solver.library, solver.reason);
    visit(stream, solver.device);
}

template <typename Stream>
void visit(Stream& stream, SavedReference& saved) {
    visit(stream, saved.made_from);
    stream.each(saved.fixed_points, [](auto& inner, auto& points) { inner(points); });
    visit(stream, saved.mesh);
    visit(stream, saved.mesher);
    SparseEntries& precision = saved.wall_precision;
    stream(precision.size, precision.rows, precision.columns, precision.values);
    visit(stream, saved.response);
    stream.each(saved.unknowns, [](auto& inner, Unknown& modulus) {
        inner(modulus.object, modulus.mean, modulus.sd);
    });
    visit(stream, saved.condensation);
}

[[noreturn]] void refuse(const fs::path& path, const std::string& why) {
    throw Error(ErrorCode::input_unreadable, fmt::format("{}: {}; make it anew with --save-reduced",
                                                         path.filename().string(), why));
}

[[noreturn]] void refuse_output(const fs::path& path, const std::string& why) {
    throw Error(ErrorCode::output_failed, fmt::format("{}: {}", path.string(), why));
}

std::string read_bytes(std::istream& in, std::size_t count) {
    std::string bytes(count, '\0');
    in.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    return bytes;
}

std::ifstream opened(const fs::path& path) {
    std::error_code failed;
    if (!fs::is_regular_file(path, failed)) {
        throw Error(ErrorCode::input_unreadable,
                    path.string() + ": no such file; check the path given to --load-reduced");
    }
    std::ifstream in(path, std::ios::binary);
    if (!in) {
        throw Error(ErrorCode::input_unreadable,
                    path.string() + ": cannot be opened; check its permissions");
    }
    return in;
}

Header read_header(std::istream& in, const fs::path& path) {
    const std::string bytes = read_bytes(in, header_bytes);
    const std::string mark(file_mark.begin(), file_mark.end());
    if (!bytes.starts_with(mark)) refuse(path, "is no saved reduced model of palpate");
    if (bytes.size() < header_bytes) refuse(path, "is cut off");
    Header header;
    ByteReader reader(bytes);
    visit(reader, header);
    if (header.byte_order != Header{}.byte_order) {
        refuse(path, "was saved on a machine of another byte order, or is damaged");
    }
    if (header.format != Header{}.format) {
        refuse(path, fmt::format("has format {}, this palpate reads format {}", header.format,
                                 Header{}.format));
    }
    return header;
}

std::string read_content(std::istream& in, const Header& header, const fs::path& path) {
    const std::uintmax_t there = fs::file_size(path) - header_bytes;
    if (there != header.content_bytes) {
        refuse(path, fmt::format("is cut off or damaged: {} bytes of content, {} expected", there,
                                 header.content_bytes));
    }
    std::string content = read_bytes(in, static_cast<std::size_t>(there));
    if (content.size() != there || content_hash(content) != header.content_hash) {
        refuse(path, "is damaged: its checksum differs");
    }
    return content;
}

bool begins_with_mark(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return read_bytes(in, file_mark.size()) == std::string(file_mark.begin(), file_mark.end());
}

}  // namespace

void check_saved_reference_path(const fs::path& path, bool overwrite) {
    std::error_code failed;
    if (fs::exists(path, failed)) {
        if (!overwrite) {
            refuse_output(path,
                          "exists already; give --save-reduced another name, or add --overwrite");
        }
        if (!fs::is_regular_file(path, failed) || !begins_with_mark(path)) {
            refuse_output(path,
                          "is no saved reduced model of palpate, so it is not replaced; give "
                          "--save-reduced another name");
        }
    }
    const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
    if (path.filename().empty() || !fs::is_directory(folder, failed) ||
        ::access(folder.c_str(), W_OK | X_OK) != 0) {
        refuse_output(path, "cannot be made; --save-reduced needs a name in a folder that exists");
    }
}

void write_saved_reference(SavedReference saved, const fs::path& path) {
    ByteWriter content, start;
    visit(content, saved);
    Header header;
    header.content_bytes = content.bytes().size();
    header.content_hash = content_hash(content.bytes());
    visit(start, header);
    write_atomically(path, [&](const fs::path& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out << start.bytes() << content.bytes();
        out.close();
        if (!out) throw Error(ErrorCode::output_failed, "not every byte could be written");
    });
}

SavedReference parse_saved_content(std::span<const char> content) {
    SavedReference saved;
    ByteReader reader(content);
    visit(reader, saved);
    if (!reader.at_end()) throw Error(ErrorCode::input_unreadable, "it is too long");
    return saved;
}

SavedReference read_saved_reference(const fs::path& path) {
    std::ifstream in = opened(path);
    const Header header = read_header(in, path);
    const std::string content = read_content(in, header, path);
    try {
        SavedReference saved = parse_saved_content(content);
        saved.name = path.filename().string();
        return saved;
    } catch (const Error& error) {
        refuse(path, fmt::format("is damaged: {}", error.what()));
    }
}

}  // namespace palpate
