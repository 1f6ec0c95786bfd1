// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/fit_step.hpp"

#include <fmt/format.h>

#include "host/apps/aspirate/tissue_fit.hpp"
#include "host/io/output_folder.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

fs::path new_folder(const OptionValues& values) {
    if (!values.is_given("out"))
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("{} writes a folder; give --out", values.text("step")));
    check_output_folder(values.path("out"), fit_result_file, values.flag("overwrite"));
    return values.path("out");
}

std::string where_report_is(const fs::path& folder) {
    return fmt::format("report: {}\n", (folder / "report.html").string());
}

}  // namespace

Outcome run_fit(const OptionValues& values, const ProgressSink& progress) {
    const fs::path folder = new_folder(values);
    const AspirationSettings settings =
        read_aspiration_settings(values.path("config"), AspirationPart::tissue);
    const Suction suction = suction_from(values, settings);
    const AspirationFitInput input =
        make_fit_input(read_profiles(values.path("frames")), suction, settings);
    Outcome outcome;
    write_folder_atomically(folder, values.flag("overwrite"), [&](const fs::path& inside) {
        outcome = fit_tissue(settings, suction, input, nullptr, inside, values, progress);
    });
    outcome.text += where_report_is(folder);
    return outcome;
}

Outcome run_film(const OptionValues& values, const ProgressSink& progress) {
    const fs::path folder = new_folder(values);
    const AspirationSettings settings =
        read_aspiration_settings(values.path("config"), AspirationPart::both);
    const Suction suction = suction_from(values, settings);
    Outcome outcome;
    write_folder_atomically(folder, values.flag("overwrite"), [&](const fs::path& inside) {
        FilmOutlines film = write_profiles(inside, values, settings.instrument, progress);
        // from the table, so that both steps one after the other give the same bytes
        const AspirationFitInput input =
            make_fit_input(read_profiles(inside / profiles_file), suction, settings);
        film.axis.column += 1000 * input.axis_mm / settings.instrument.pixel_r_um;
        outcome = fit_tissue(settings, suction, input, &film, inside, values, progress);
    });
    outcome.text += where_report_is(folder);
    return outcome;
}

}  // namespace palpate
