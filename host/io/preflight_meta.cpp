// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>

#include "host/io/preflight.hpp"

namespace palpate::detail {
namespace {

using Fields = std::map<std::string, std::string>;

/// The "Name = value" lines up to ElementDataFile; `end` receives where data inside the file begin.
Fields meta_fields(const std::vector<std::uint8_t>& bytes, std::size_t& end) {
    const std::string text(bytes.begin(),
                           bytes.begin() + std::min<std::size_t>(bytes.size(), 1 << 16));
    Fields fields;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t line_end = std::min(text.find('\n', begin), text.size());
        const std::string line = text.substr(begin, line_end - begin);
        begin = line_end + 1;
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos || line.find('\0') != std::string::npos) {
            unreadable("it is not a MetaImage file, or its header is damaged");
        }
        const std::string name = trimmed(line.substr(0, equals));
        if (!fields.emplace(name, trimmed(line.substr(equals + 1))).second) {
            unreadable("its header has a field twice: " + name.substr(0, 40));
        }
        if (name == "ElementDataFile") {
            end = std::min(begin, bytes.size());
            return fields;
        }
    }
    unreadable("its header has no end (ElementDataFile)");
}

std::string optional(const Fields& fields, const std::string& name) {
    const auto found = fields.find(name);
    return found == fields.end() ? "" : found->second;
}

bool is_true(const std::string& text) {
    return !text.empty() && (text[0] == 'T' || text[0] == 't' || text[0] == '1');
}

std::size_t meta_voxel_bytes(const std::string& type) {
    static const std::map<std::string, std::size_t> bytes_of{
        {"MET_CHAR", 1},  {"MET_UCHAR", 1},  {"MET_SHORT", 2},     {"MET_USHORT", 2},
        {"MET_INT", 4},   {"MET_UINT", 4},   {"MET_LONG", 4},      {"MET_ULONG", 4},
        {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}, {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}};
    const auto found = bytes_of.find(type);
    if (found == bytes_of.end()) {
        unusable("its voxels are of type '" + type.substr(0, 40) + "', not plain numbers");
    }
    return found->second;
}

void check_fields(const Fields& fields) {
    const auto expect_numbers = [&](const char* name, std::size_t count) {
        const std::string text = optional(fields, name);
        if (!text.empty() && finite_numbers(text).size() != count) {
            unreadable(std::string("its header has a bad ") + name);
        }
    };
    for (const char* name : {"TransformMatrix", "Rotation", "Orientation"}) expect_numbers(name, 9);
    for (const char* name :
         {"Offset", "Position", "Origin", "ElementSpacing", "ElementSize", "CenterOfRotation"}) {
        expect_numbers(name, 3);
    }
    const std::string object = optional(fields, "ObjectType");
    if (!object.empty() && object != "Image") unusable("it is not an image");
    const std::string channels = optional(fields, "ElementNumberOfChannels");
    if (!channels.empty() && channels != "1") unusable("it has several numbers per voxel");
    const std::string units = optional(fields, "DistanceUnits");
    if (!units.empty() && units != "mm" && units != "?") {
        unusable("its lengths are in '" + units.substr(0, 20) + "'; only mm are accepted");
    }
    const std::string binary = optional(fields, "BinaryData");
    if (!binary.empty() && !is_true(binary)) unreadable("its voxels are text; save it as binary");
    const std::string header_size = optional(fields, "HeaderSize");
    if (!header_size.empty() && header_size != "0") {
        unreadable("its header uses HeaderSize, which is not supported");
    }
}

/// What says where the voxels lie and how they are stored, and nothing else.
std::string clean_meta_header(const Fields& fields) {
    std::string header = "ObjectType = Image\nBinaryData = True\nCompressedData = False\n";
    for (const char* name :
         {"NDims", "BinaryDataByteOrderMSB", "ElementByteOrderMSB", "TransformMatrix", "Rotation",
          "Orientation", "Offset", "Position", "Origin", "CenterOfRotation", "ElementSpacing",
          "ElementSize", "DimSize", "ElementType"}) {
        const std::string value = optional(fields, name);
        if (!value.empty()) header += std::string(name) + " = " + value + "\n";
    }
    return header + "ElementDataFile = LOCAL\n";
}

}  // namespace

CheckedVolume preflight_meta(std::vector<std::uint8_t> bytes, const std::filesystem::path& folder,
                             bool detached) {
    std::size_t end = 0;
    const Fields fields = meta_fields(bytes, end);
    check_fields(fields);
    CheckedVolume volume;
    volume.format = VolumeFormat::meta;
    const std::vector<long long> dimension = whole_numbers(optional(fields, "NDims"));
    const std::vector<long long> sizes = whole_numbers(optional(fields, "DimSize"));
    if (dimension.size() != 1 || dimension[0] != static_cast<long long>(sizes.size())) {
        unreadable("its header contradicts itself (NDims and DimSize)");
    }
    const std::size_t needed =
        checked_num_voxels(sizes) * meta_voxel_bytes(optional(fields, "ElementType"));
    volume.size = {Index(sizes[0]), Index(sizes[1]), Index(sizes[2])};
    const bool compressed = is_true(optional(fields, "CompressedData"));
    const std::string data_name = optional(fields, "ElementDataFile");
    const auto take = [&](std::span<const std::uint8_t> data) {
        volume.file =
            joined("volume.mha", clean_meta_header(fields), checked_data(data, compressed, needed));
        return volume;
    };
    if (data_name == "LOCAL" || data_name == "Local" || data_name == "local") {
        return take(std::span(bytes).subspan(end));
    }
    if (!detached) unreadable("its header names another file; such a header is called .mhd");
    if (data_name.rfind("LIST", 0) == 0 || data_name.find('%') != std::string::npos) {
        unreadable("its voxels are spread over several files; save it as one");
    }
    return take(load_detached(folder, data_name));
}

}  // namespace palpate::detail
