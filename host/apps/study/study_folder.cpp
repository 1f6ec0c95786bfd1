// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/study/study_folder.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const fs::path& folder, const std::string& what) {
    throw Error(
        ErrorCode::output_failed,
        fmt::format("{} {}; name another folder with --out, or add --overwrite to begin again",
                    folder.string(), what));
}

std::string content_of(const fs::path& path) {
    constexpr std::uintmax_t largest_bytes = std::uintmax_t(64) << 20;  // of a very large study
    std::error_code failed;
    if (!fs::is_regular_file(path, failed) || fs::file_size(path, failed) > largest_bytes)
        fail(path, "is no file of a study");
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Throws unless study.json in `folder` is of the same study with the same settings.
void check_is_the_same(const Study& study, const fs::path& folder) {
    const Json json = Json::parse(content_of(folder / "study.json"), nullptr, false);
    if (!json.is_object() || !json.contains("study") || !json["study"].is_string() ||
        !json.contains("settings") || !json["settings"].is_object())
        fail(folder, "holds a study.json that cannot be read");
    if (json["study"] != study.name)
        fail(folder,
             fmt::format("holds the study '{}', not '{}'", json.value("study", ""), study.name));
    for (const auto& [name, value] : study.settings) {
        const auto found = json["settings"].find(name);
        const bool is_text = found != json["settings"].end() && found->is_string();
        const std::string there = is_text ? found->get<std::string>() : "none";
        if (there != value)
            fail(folder, fmt::format("holds this study with {} {}, but {} was asked for", name,
                                     there, value));
    }
}

/// Refuses to touch a folder that no study made.
void check_may_write(const fs::path& folder) {
    if (!fs::exists(folder)) return;
    if (!fs::is_directory(folder)) {
        throw Error(ErrorCode::output_failed,
                    folder.string() + " is a file; name another folder with --out");
    }
    if (!fs::is_empty(folder) && !fs::exists(folder / "study.json")) {
        throw Error(ErrorCode::output_failed,
                    folder.string() + " holds files but no study; name another folder with --out");
    }
}

}  // namespace

void replace_file(const fs::path& path, const std::string& text) {
    write_atomically(path, [&](const fs::path& temporary) { write_text_file(temporary, text); });
}

std::string study_json(const Study& study, const std::vector<Fact>& facts) {
    Json json{{"study", study.name}, {"version", version_text()}, {"settings", Json::object()}};
    for (const auto& [name, value] : study.settings) json["settings"][name] = value;
    for (const auto& [name, value] : facts) json["summary"][name] = value;
    return json.dump(2) + "\n";
}

StudyFolder::StudyFolder(const Study& study, const fs::path& folder, bool overwrite)
    : study_(study), folder_(folder) {
    check_may_write(folder);
    const bool is_there = fs::exists(folder / "study.json");
    if (is_there && overwrite) {
        for (const char* name : {"study.csv", "study.html", "pictures"})
            fs::remove_all(folder / name);
    } else if (is_there) {
        check_is_the_same(study, folder);
        if (fs::exists(folder / "study.csv")) {
            rows_ = parse_csv(content_of(folder / "study.csv"), (folder / "study.csv").string());
        }
    }
    std::error_code failed;
    fs::create_directories(folder, failed);
    if (failed) fail(folder, "cannot be made (" + failed.message() + ")");
    if (!is_there || overwrite) replace_file(folder / "study.json", study_json(study, {}));
}

void StudyFolder::write_rows(const std::vector<Row>& rows) const {
    std::vector<std::string> columns{"case"};
    columns.insert(columns.end(), study_.columns.begin(), study_.columns.end());
    replace_file(folder_ / "study.csv", to_csv(columns, rows));
}

}  // namespace palpate
