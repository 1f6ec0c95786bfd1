// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/result_folder.hpp"

#include <future>

#include "host/apps/recover/report/html_report.hpp"
#include "host/apps/recover/report/recovery_tree.hpp"
#include "host/apps/recover/report/text_report.hpp"
#include "host/apps/recover/report/vtk_report.hpp"
#include "host/io/files.hpp"
#include "host/io/output_folder.hpp"
#include "host/io/volume_files.hpp"
#include "host/page/tree_json.hpp"

namespace palpate {
namespace fs = std::filesystem;

void check_result_folder(const fs::path& folder, bool overwrite) {
    check_output_folder(folder, "result.json", overwrite);
}

void check_targets_folder(const fs::path& folder, const std::vector<std::string>& names,
                          bool overwrite) {
    check_output_folder(folder, targets_file_name, overwrite);
    for (const std::string& name : names) check_result_folder(folder / name, overwrite);
}

void write_targets_files(const fs::path& folder, const std::string& table,
                         const std::string& page) {
    make_folders(folder);
    for (const auto& file :
         {std::pair{targets_file_name, &table}, std::pair{targets_page_name, &page}})
        write_atomically(folder / file.first, [&](const fs::path& temporary) {
            write_text_file(temporary, *file.second);
        });
}

void write_result_files(const RecoveryResult& result, const fs::path& inside,
                        const ResultOptions& options) {
    // Compressing the fields is most of it: each on a thread beside the rest.
    auto forward = std::async(std::launch::async, [&] {
        write_fields(inside, forward_field, result.displacement_field, options.fields);
    });
    auto backward = std::async(std::launch::async, [&] {
        write_fields(inside, backward_field, result.inverse_displacement_field, options.fields);
    });
    write_text_file(inside / "result.json",
                    tree_json(recovery_tree(result, options.include_file_names, options.fields)));
    write_text_file(inside / "convergence.csv", convergence_csv(result));
    write_text_file(inside / "report.html", html_report(result, options.include_file_names,
                                                        options.images, options.fields));
    write_vtk_report(result, inside / "mesh.vtu");
    write_label_image(inside / "warped_labels.nii.gz", result.warped_labels);
    forward.get();
    backward.get();
}

void write_result(const RecoveryResult& result, const fs::path& folder,
                  const ResultOptions& options) {
    check_result_folder(folder, options.overwrite);
    write_folder_atomically(folder, options.overwrite, [&](const fs::path& inside) {
        write_result_files(result, inside, options);
    });
}

}  // namespace palpate
