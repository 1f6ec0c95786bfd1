// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/recover/report/grey_picture.hpp"
#include "host/apps/recover/result/recovery_result.hpp"
#include "host/geometry/warping/field_files.hpp"

namespace palpate {

struct ResultOptions {
    bool overwrite = false;           ///< replace an older result folder of the same name
    bool include_file_names = false;  ///< input file names (they may hold a patient's name)
    FieldChoice fields = FieldChoice::one;
    GreyImages images;  ///< for report.html, which then shows the patient's anatomy
};

/// Throws Error(output_failed) if `write_result` would refuse `folder`: it exists and may not be
/// replaced, or its parent cannot be written. Call it before a long computation.
void check_result_folder(const std::filesystem::path& folder, bool overwrite);

/// Writes the result folder, all or nothing: result.json, mesh.vtu, the chosen files of the
/// displacement in both senses (host/geometry/warping/field_files.hpp), warped_labels.nii.gz,
/// convergence.csv, report.html. Missing parent folders are made.
/// An existing folder is replaced only with `overwrite`, and only if it is empty or holds a
/// result.json.
/// Throws Error(output_failed) and leaves nothing behind.
void write_result(const RecoveryResult& result, const std::filesystem::path& folder,
                  const ResultOptions& options = {});

/// The same files into the folder `inside`, which is there.
void write_result_files(const RecoveryResult& result, const std::filesystem::path& inside,
                        const ResultOptions& options);

/// In the folder of a run with several targets, beside one result folder for each.
inline constexpr const char* targets_file_name = "targets.csv";
inline constexpr const char* targets_page_name = "targets.html";

/// The same for a folder that will hold the result folders `names`. An existing one is used only
/// with `overwrite`, and only if it holds a targets.csv; of what is in it, only the result folders
/// `names`, targets.csv and targets.html are replaced.
void check_targets_folder(const std::filesystem::path& folder,
                          const std::vector<std::string>& names, bool overwrite);

/// Writes or replaces targets.csv and targets.html. Missing folders are made. Throws
/// Error(output_failed).
void write_targets_files(const std::filesystem::path& folder, const std::string& table,
                         const std::string& page);

}  // namespace palpate
