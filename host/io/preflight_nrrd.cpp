// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <sstream>

#include "host/io/preflight.hpp"

namespace palpate::detail {
namespace {

using Fields = std::map<std::string, std::string>;

/// The "field: value" lines up to the first blank line; `end` receives where the data begin.
Fields nrrd_fields(const std::vector<std::uint8_t>& bytes, std::size_t& end) {
    const std::string text(bytes.begin(),
                           bytes.begin() + std::min<std::size_t>(bytes.size(), 1 << 20));
    if (text.rfind("NRRD000", 0) != 0) unreadable("it is not an NRRD file");
    Fields fields;
    std::size_t begin = text.find('\n');
    while (begin != std::string::npos) {
        ++begin;
        const std::size_t line_end = text.find('\n', begin);
        const std::string line =
            text.substr(begin, line_end == std::string::npos ? line_end : line_end - begin);
        if (trimmed(line).empty()) {
            end = line_end == std::string::npos ? bytes.size() : line_end + 1;
            return fields;
        }
        const std::size_t colon = line.find(": ");
        if (line[0] != '#' && colon != std::string::npos && line.find(":=") > colon) {
            const std::string name = trimmed(line.substr(0, colon));
            if (!fields.emplace(name, trimmed(line.substr(colon + 2))).second)
                unreadable("its header has a field twice: " + name.substr(0, 40));
        }
        begin = line_end;
    }
    end = bytes.size();
    return fields;
}

const std::string& required(const Fields& fields, const std::string& name) {
    const auto found = fields.find(name);
    if (found == fields.end()) unreadable("its header has no '" + name + "'");
    return found->second;
}

std::string either_of(const Fields& fields, const std::string& name,
                      const std::string& other = "") {
    const auto found = fields.find(fields.count(name) ? name : other);
    return found == fields.end() ? "" : found->second;
}

std::size_t nrrd_voxel_bytes(const std::string& type) {
    static const std::map<std::string, std::size_t> bytes_of = [] {
        std::map<std::string, std::size_t> result;
        for (const char* name :
             {"signed char", "int8", "int8_t", "uchar", "unsigned char", "uint8", "uint8_t"})
            result[name] = 1;
        for (const char* name :
             {"short", "short int", "signed short", "signed short int", "int16", "int16_t",
              "ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"})
            result[name] = 2;
        for (const char* name : {"int", "signed int", "int32", "int32_t", "uint", "unsigned int",
                                 "uint32", "uint32_t", "float"})
            result[name] = 4;
        for (const char* name :
             {"longlong", "long long", "long long int", "signed long long", "signed long long int",
              "int64", "int64_t", "ulonglong", "unsigned long long", "unsigned long long int",
              "uint64", "uint64_t", "double"})
            result[name] = 8;
        return result;
    }();
    const auto found = bytes_of.find(type);
    if (found == bytes_of.end())
        unusable("its voxels are of type '" + type + "', not plain numbers");
    return found->second;
}

void check_space(const Fields& fields) {
    std::istringstream kinds(either_of(fields, "kinds"));
    for (std::string kind; kinds >> kind;) {
        if (kind != "domain" && kind != "space" && kind != "none" && kind != "???") {
            unusable("an axis of it is of kind '" + kind + "', not space");
        }
    }
    std::istringstream units(either_of(fields, "space units", "units"));
    for (std::string unit; units >> unit;) {
        std::erase(unit, '"');
        if (!unit.empty() && unit != "mm" && unit != "millimeter" && unit != "millimetre") {
            unusable("its lengths are in '" + unit + "'; only mm are accepted");
        }
    }
    for (const char* name : {"space directions", "space origin", "spacings"}) {
        std::string numbers = either_of(fields, name);
        std::replace_if(
            numbers.begin(), numbers.end(), [](char c) { return c == '(' || c == ')' || c == ','; },
            ' ');
        const std::size_t count = finite_numbers(numbers).size();
        const std::size_t wanted = std::string(name) == "space directions" ? 9 : 3;
        if (!numbers.empty() && count != wanted) {
            unreadable(std::string("its header has a bad '") + name + "'");
        }
    }
    for (const char* name : {"byte skip", "byteskip", "line skip", "lineskip"}) {
        const std::string skip = either_of(fields, name);
        if (!skip.empty() && skip != "0") {
            unreadable(std::string("its header uses '") + name + "', which is not supported");
        }
    }
}

/// What says where the voxels lie and how they are stored, and nothing else.
std::string clean_nrrd_header(const Fields& fields) {
    std::string header = "NRRD0004\n";
    for (const char* name :
         {"type", "dimension", "space", "space dimension", "sizes", "space directions", "spacings",
          "axis mins", "axismins", "axis maxs", "axismaxs", "centers", "centerings", "kinds",
          "endian", "space origin"}) {
        const std::string value = either_of(fields, name);
        if (!value.empty()) header += std::string(name) + ": " + value + "\n";
    }
    return header + "encoding: raw\n\n";
}

}  // namespace

CheckedVolume preflight_nrrd(std::vector<std::uint8_t> bytes, const std::filesystem::path& folder,
                             bool detached) {
    std::size_t end = 0;
    const Fields fields = nrrd_fields(bytes, end);
    CheckedVolume volume;
    volume.format = VolumeFormat::nrrd;
    const std::vector<long long> dimension = whole_numbers(required(fields, "dimension"));
    const std::vector<long long> sizes = whole_numbers(required(fields, "sizes"));
    if (dimension.size() != 1 || dimension[0] != static_cast<long long>(sizes.size())) {
        unreadable("its header contradicts itself (dimension and sizes)");
    }
    const std::size_t needed =
        checked_num_voxels(sizes) * nrrd_voxel_bytes(required(fields, "type"));
    volume.size = {Index(sizes[0]), Index(sizes[1]), Index(sizes[2])};
    check_space(fields);
    const std::string encoding = required(fields, "encoding");
    const bool compressed = encoding == "gzip" || encoding == "gz";
    if (!compressed && encoding != "raw") {
        unreadable("its encoding is '" + encoding + "'; save it as raw or gzip");
    }
    const auto take = [&](std::span<const std::uint8_t> data) {
        volume.file = joined("volume.nrrd", clean_nrrd_header(fields),
                             checked_data(data, compressed, needed));
        return volume;
    };
    const std::string data_name = either_of(fields, "data file", "datafile");
    if (data_name.empty()) {
        if (detached) unreadable("its header names no data file");
        return take(std::span(bytes).subspan(end));
    }
    if (data_name.rfind("LIST", 0) == 0 || data_name.find('%') != std::string::npos) {
        unreadable("its voxels are spread over several files; save it as one");
    }
    return take(load_detached(folder, data_name));
}

}  // namespace palpate::detail
