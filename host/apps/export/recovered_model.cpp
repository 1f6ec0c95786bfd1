// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/export/recovered_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "host/geometry/meshing/mesh_files.hpp"
#include "host/io/files.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

[[noreturn]] void unreadable(const fs::path& file, const std::string& why) {
    throw Error(ErrorCode::input_unreadable,
                fmt::format("cannot use '{}': {}; give a result folder of `palpate recover`",
                            file.string(), why));
}

/// Files from elsewhere may be deep enough to break a parser, or too large.
Json read_json(const fs::path& path) {
    constexpr int deepest = 32;
    constexpr std::uintmax_t largest = std::uintmax_t(64) << 20;
    if (const auto why = why_unreadable(path)) unreadable(path, *why);
    if (fs::file_size(path) > largest) unreadable(path, "it is larger than 64 MiB");
    const auto bounded = [&](int depth, Json::parse_event_t, Json&) {
        if (depth > deepest) unreadable(path, "it is nested too deeply");
        return true;
    };
    std::ifstream in(path, std::ios::binary);
    try {
        return Json::parse(in, bounded);
    } catch (const Json::exception&) {
        unreadable(path, "it is not JSON");
    }
}

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c += 'a' - 'A';
    return text;
}

std::string token_of(const std::string& name, std::set<std::string>& taken) {
    std::string token;
    for (const char c : name) {
        const bool plain =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (plain || (!token.empty() && token.back() != '_')) token += plain ? c : '_';
    }
    while (!token.empty() && token.back() == '_') token.pop_back();
    token.resize(std::min<std::size_t>(token.size(), 60));
    if (token.empty() || (token[0] >= '0' && token[0] <= '9')) token = "region_" + token;
    std::string unique = token;
    // Solvers take ABC and abc for one name.
    for (int n = 2; !taken.insert(lower_case(unique)).second; ++n)
        unique = fmt::format("{}_{}", token, n);
    return unique;
}

/// It goes into comments of four formats: nothing that could end one.
std::string plain_version(const std::string& text) {
    std::string plain;
    for (const char c : text.substr(0, 40)) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (letter || (c >= '0' && c <= '9') || c == '.' || c == '+') plain += c;
    }
    return plain;
}

std::vector<ModelRegion> regions_of(const Json& json, const Mesh& mesh) {
    std::vector<ModelRegion> regions;
    std::set<std::string> taken;
    for (const Json& entry : json.at("regions")) {
        ModelRegion region;
        region.label = entry.at("label").get<Index>();
        for (Index t = 0; t < mesh.num_tets(); ++t) {
            if (mesh.region[t] == region.label) region.tets.push_back(t);
        }
        if (region.tets.empty()) continue;
        region.name = entry.at("name").get<std::string>();
        region.token = token_of(region.name, taken);
        region.stiffness_kpa =
            entry.at(entry.contains("most_probable_kpa") ? "most_probable_kpa" : "stiffness_kpa")
                .get<double>();
        region.poisson_ratio = entry.at("poisson_ratio").get<double>();
        regions.push_back(std::move(region));
    }
    return regions;
}

template <typename T>
const std::vector<T>& array_of(const std::map<std::string, std::vector<T>>& arrays,
                               const char* name, std::size_t size, const fs::path& file) {
    const auto found = arrays.find(name);
    if (found == arrays.end() || found->second.size() != size) {
        throw Error(ErrorCode::input_unusable,
                    fmt::format("'{}' has no point array {}; run `palpate recover` of this version",
                                file.string(), name));
    }
    return found->second;
}

void take_fields(const MeshArrays& arrays, const fs::path& file, RecoveredModel& model) {
    const std::size_t count = model.mesh.nodes.size();
    model.displacement = array_of(arrays.point_vectors, "displacement", count, file);
    model.force = array_of(arrays.point_vectors, "force", count, file);
    for (const double held : array_of(arrays.point_scalars, "held", count, file)) {
        if (held != 0 && held != 1 && held != 2) unreadable(file, "its array held is damaged");
        model.held.push_back(static_cast<Held>(static_cast<int>(held)));
    }
}

/// A result that does not name its elements is of tet4.
void require_tet4(const Json& json, const fs::path& file) {
    const Json mesh = json.value("mesh", Json::object());
    const std::string element = mesh.is_object() ? mesh.value("element_type", "tet4") : "tet4";
    if (element == "tet4") return;
    throw Error(ErrorCode::unsupported,
                fmt::format("'{}' is of {} elements, and models are written of tet4 only; recover "
                            "with --element tet4",
                            file.string(), element));
}

std::size_t num_tets_in(const std::vector<ModelRegion>& regions) {
    std::size_t sum = 0;
    for (const ModelRegion& region : regions) sum += region.tets.size();
    return sum;
}

}  // namespace

std::vector<Index> RecoveredModel::nodes_that_are(Held kind) const {
    std::vector<Index> nodes;
    for (Index n = 0; n < mesh.num_nodes(); ++n) {
        if (held[n] == kind) nodes.push_back(n);
    }
    return nodes;
}

std::string RecoveredModel::description_of(const ModelRegion& region) const {
    return fmt::format("label {}: Young's modulus {:.6g} kPa, Poisson's ratio {:.6g}, law {}",
                       region.label, region.stiffness_kpa, region.poisson_ratio, law.name);
}

RecoveredModel read_recovered_model(const fs::path& folder) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) unreadable(folder, "it is not a folder");
    const fs::path json_file = folder / "result.json", mesh_file = folder / "mesh.vtu";
    const Json json = read_json(json_file);
    try {
        require_tet4(json, json_file);
    } catch (const Json::exception&) {
        unreadable(json_file, "it does not name its elements");
    }
    RecoveredModel model;
    MeshArrays arrays;
    model.mesh = read_vtu(mesh_file, "region", &arrays);
    take_fields(arrays, mesh_file, model);
    try {
        model.version = plain_version(json.at("version").get<std::string>());
        model.law = tissue_law_of(json.at("material").get<std::string>());
        model.regions = regions_of(json, model.mesh);
    } catch (const Json::exception&) {
        unreadable(json_file, "it misses a material, or a region's name, modulus or ratio");
    }
    if (num_tets_in(model.regions) != model.mesh.tets.size()) {
        unreadable(mesh_file, "it has a label that is not, or more than once, in result.json");
    }
    return model;
}

}  // namespace palpate
