// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/report/html_report.hpp"

#include <fmt/format.h>

#include "host/report/assets.hpp"
#include "host/report/findings.hpp"
#include "host/report/html_tables.hpp"
#include "host/report/label_volumes.hpp"
#include "host/report/markup.hpp"
#include "host/report/report_plots.hpp"
#include "host/report/static_slices.hpp"
#include "host/report/viewer_data.hpp"

namespace palpate {
namespace {

/// A section, or nothing if it has no content.
std::string section(const std::string& id, const std::string& title, const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<section id='{}'><h2>{}</h2>{}</section>", id, title, content);
}

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

std::string html_report(const RecoveryResult& result, bool include_file_names) {
    const LabelVolumes volumes = label_volumes(result);
    const auto slice = [&](SliceView view) {
        return volumes.empty() ? std::string() : static_slice_svg(result, volumes, view);
    };
    const std::string figures = profile_figures(result) + convergence_figures(result);
    return fill_template(
        report_html_template(),
        {{"css", std::string(report_css())},
         {"version", escape_html(result.version)},
         {"headline", headline_html(result)},
         {"inputs", inputs_line(result, include_file_names)},
         {"summary", plain_summary(result)},
         {"notices", notices_html(result)},
         {"findings", findings_html(result)},
         {"intervals", interval_figure(result)},
         {"regions", regions_table_html(result)},
         {"surfaces", surfaces_table_html(result)},
         {"axial", slice(SliceView::axial)},
         {"coronal", slice(SliceView::coronal)},
         {"sagittal", slice(SliceView::sagittal)},
         {"slices_note", escape_html(slices_note(result, volumes))},
         {"certainty", section("certainty", "How sure is it",
                               figures.empty() ? ""
                                               : "<div class='figures'>" + figures +
                                                     correlation_table_html(result) +
                                                     sensitivity_table_html(result) + "</div>")},
         {"details", details_html(result)},
         {"settings", escape_html(to_toml(result.settings))},
         {"data", viewer_data(result, volumes)},
         {"scripts", std::string(surface_viewer_js()) + std::string(slice_viewer_js()) +
                         std::string(report_js())}});
}

}  // namespace palpate
