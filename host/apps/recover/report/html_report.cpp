// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/report/html_report.hpp"

#include <fmt/format.h>

#include "host/apps/recover/report/assets.hpp"
#include "host/apps/recover/report/findings.hpp"
#include "host/apps/recover/report/html_tables.hpp"
#include "host/apps/recover/report/label_volumes.hpp"
#include "host/apps/recover/report/report_plots.hpp"
#include "host/apps/recover/report/shown_picture.hpp"
#include "host/apps/recover/report/static_slices.hpp"
#include "host/apps/recover/report/viewer_data.hpp"
#include "host/page/assets.hpp"
#include "host/page/markup.hpp"
#include "host/page/page.hpp"
#include "host/page/surface_view.hpp"

namespace palpate {
namespace {

std::string slices_note(const RecoveryResult& result, const LabelVolumes& volumes) {
    if (volumes.empty()) return "No organ has a voxel on the reference grid: nothing to show.";
    std::string text = fmt::format(
        "Voxels of {} × {} × {} mm (left–right, front–back, up–down), "
        "drawn in true proportions.",
        significant(volumes.spacing[0]), significant(volumes.spacing[1]),
        significant(volumes.spacing[2]));
    if (volumes.tilt_deg > 0.5)
        text += fmt::format(
            " The slices follow the image grid, which is tilted by up to {}° to the "
            "patient axes.",
            decimals(volumes.tilt_deg, 1));
    if (result.target_labels_aligned.voxels.empty())
        text += " The target has no labels: its surfaces and points show where a slice cuts them.";
    return text;
}

constexpr const char* plain_lines =
    "Tinted areas: reference. Thick grey line: target, aligned. Thin coloured line: reference "
    "carried by the deformation.";

/// What the lines mean, on each ground that the slices can have.
std::string lines_note(const ShownPictures& pictures) {
    std::string text;
    if (!pictures.target.empty())
        text +=
            "On the target image: white line, target; thin coloured line, reference carried by "
            "the deformation. ";
    if (!pictures.reference.empty())
        text += "On the reference image, rigidly aligned: coloured line, reference. ";
    if (text.empty()) return plain_lines;
    return text +
           "Without an image: tinted areas, reference; thick grey line, target, aligned; "
           "thin coloured line, reference carried by the deformation.";
}

std::string picture_note(const char* which, const ShownPicture& picture,
                         const LabelVolumes& volumes) {
    if (picture.empty()) return "";
    const auto spacing_mm = [&](int a) {
        return significant(volumes.spacing[a] * volumes.size[a] / picture.grey.size[a]);
    };
    return fmt::format(" {} image: grey from {} (black) to {} (white), voxels of {} × {} × {} mm.",
                       which, significant(picture.grey.window.black),
                       significant(picture.grey.window.white), spacing_mm(0), spacing_mm(1),
                       spacing_mm(2));
}

/// The row of slices, and a second one for paper where there are images.
std::string slices_html(const RecoveryResult& result, const LabelVolumes& volumes,
                        const ShownPictures& pictures) {
    const std::vector<SliceGround> grounds = slice_grounds(pictures);
    std::string out = slice_figures(result, volumes, pictures, grounds.front());
    if (grounds.size() > 1) out += slice_figures(result, volumes, pictures, grounds[1], "on-paper");
    return out;
}

std::string file_html(const char* name) { return fmt::format("<code>{}</code>", name); }

/// The end of the sentence that names the files beside the page.
std::string displacements_html(FieldChoice fields) {
    if (!has_image(fields)) return "";
    std::string out = "; displacement";
    const char* before = "";
    for (const FieldFile& f : {forward_field, backward_field}) {
        out += fmt::format("{} of points of the {} to the {}: {}", before, f.points_from,
                           f.points_to, file_html(f.field));
        if (has_transform(fields)) out += ", as ITK transform " + file_html(f.transform);
        before = ";";
    }
    return has_transform(fields)
               ? out
               : out + " (<code>palpate export</code> makes ITK transforms of them)";
}

std::string inputs_line(const RecoveryResult& result, bool include_file_names) {
    if (!include_file_names) return "";
    return "<p class='kind'>" + escape_html(result.reference_name) + " → " +
           escape_html(result.target_name) + "</p>";
}

std::string plain_summary(const RecoveryResult& result) {
    std::string out;
    for (const std::string& text : {surfaces_sentence(result), termination_sentence(result)})
        if (!text.empty()) out += escape_html(text) + " ";
    return out;
}

}  // namespace

std::string html_report(const RecoveryResult& result, bool include_file_names,
                        const GreyImages& images, FieldChoice fields) {
    const double margin_mm = images.empty() ? 8 : 15;  // what lies round organs tells images apart
    const LabelVolumes volumes = label_volumes(result, most_shown_voxels, margin_mm);
    const ShownPictures pictures = shown_pictures(images, result, volumes);
    const std::string figures = profile_figures(result) + convergence_figures(result);
    const std::string space = surface_viewer_html(recovery_view(result));
    Page page{.kind = "Stiffness from two segmentations of one patient",
              .version = result.version,
              .headline = headline_html(result),
              .lead = inputs_line(result, include_file_names) + "<p class='summary'>" +
                      plain_summary(result) + "</p>",
              .notices = notices_html(result),
              .footer =
                  "Frame: LPS (x to the patient's left, y to the back, z to the head); "
                  "lengths in mm, moduli in kPa. Numbers: <code>result.json</code>; fields: "
                  "<code>mesh.vtu</code>, <code>warped_labels.nii.gz</code>" +
                  displacements_html(fields) + ".",
              .scripts = surface_viewer_script() + std::string(slice_viewer_js()) +
                         std::string(report_js())};
    page.main = fill_template(
        report_html_template(),
        {{"findings", findings_html(result)},
         {"intervals", interval_figure(result)},
         {"regions", regions_table_html(result)},
         {"surfaces", surfaces_table_html(result)},
         {"space", section_html("space", "Surfaces in space", space)},
         {"slices", slices_html(result, volumes, pictures)},
         {"lines_note", lines_note(pictures)},
         {"slices_note", escape_html(slices_note(result, volumes)) +
                             picture_note("Target", pictures.target, volumes) +
                             picture_note("Reference", pictures.reference, volumes)},
         {"certainty",
          section_html("certainty", "How sure is it",
                       figures.empty()
                           ? ""
                           : "<div class='figures'>" + figures + correlation_table_html(result) +
                                 sensitivity_table_html(result) + "</div>")},
         {"details", details_html(result)},
         {"settings", escape_html(to_toml(result.settings))},
         {"data", viewer_data(result, volumes, pictures)}});
    return page_html(page);
}

}  // namespace palpate
