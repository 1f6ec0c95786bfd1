// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/contours_step.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "host/apps/aspirate/film_outlines.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/page.hpp"
#include "host/page/tree_html.hpp"
#include "host/page/tree_json.hpp"
#include "host/page/tree_text.hpp"
#include "host/system/version.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::string contours_page(const FilmOutlines& film, const ResultTree& tree,
                          const AspirationInstrument& instrument) {
    return page_html(
        {.kind = "palpate aspirate contours",
         .version = version_text(),
         .headline = fmt::format("Outlines in {} frames", film.num_frames),
         .lead = "<p class='summary'>Outlines of tissue in the frames of a film.</p>",
         .main = section_html("figures", "Figures", tree_html(tree)) +
                 film_sections(film.strip, film.time_s, film.apex_mm, film_lines(film, instrument)),
         .footer = "All points: <code>profiles.csv</code>.",
         .style = film_style});
}

}  // namespace

Outcome run_contours(const OptionValues& values, const ProgressSink& progress) {
    const AspirationInstrument instrument =
        read_aspiration_settings(values.path("config"), AspirationPart::frames).instrument;
    if (!values.is_given("out")) {
        const FilmOutlines film = follow_film(
            values, instrument,
            [](const std::string& rows) {
                std::fwrite(rows.data(), 1, rows.size(), stdout);
                if (std::fflush(stdout) != 0)
                    throw Error(ErrorCode::output_failed, "cannot write to standard output");
            },
            progress);
        return {.result = outlines_tree(film, instrument),
                .text = fmt::format("# {} frames, axis at column {:.2f}\n", film.num_frames,
                                    axis_column_px(film, instrument))};
    }
    const std::filesystem::path folder = values.path("out");
    check_output_folder(folder, profiles_file, values.flag("overwrite"));
    Outcome outcome;
    write_folder_atomically(folder, values.flag("overwrite"), [&](const auto& inside) {
        const FilmOutlines film = write_profiles(inside, values, instrument, progress);
        outcome.result = outlines_tree(film, instrument);
        write_text_file(inside / "result.json", tree_json(outcome.result));
        write_text_file(inside / "contours.html", contours_page(film, outcome.result, instrument));
    });
    outcome.text =
        tree_text(outcome.result) + fmt::format("page: {}/contours.html\n", folder.string());
    return outcome;
}

}  // namespace palpate
