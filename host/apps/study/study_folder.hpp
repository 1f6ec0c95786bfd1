// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/apps/study/study.hpp"

namespace palpate {

/// The files of a study that may be interrupted and resumed: study.json says what it is, study.csv
/// holds the rows. Every file is replaced in one step.
class StudyFolder {
public:
    /// Makes the folder, or opens one with the same study and settings (`overwrite`: empties it).
    /// Throws Error(output_failed) naming the first difference.
    StudyFolder(const Study& study, const std::filesystem::path& folder, bool overwrite);

    /// Rows that are there already, by case id; rows of no case of the study are left out.
    const std::vector<Row>& rows() const { return rows_; }
    void write_rows(const std::vector<Row>& rows) const;

private:
    const Study& study_;
    std::filesystem::path folder_;
    std::vector<Row> rows_;
};

/// Writes beside the file, then renames. Throws Error(output_failed).
void replace_file(const std::filesystem::path& path, const std::string& text);

/// study.json: name, settings, version, facts; facts are null where they are not finite.
std::string study_json(const Study& study, const std::vector<Fact>& facts);

}  // namespace palpate
