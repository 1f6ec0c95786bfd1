// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/aspirate_application.hpp"

#include "host/apps/aspirate/contours_step.hpp"
#include "host/apps/aspirate/fit_step.hpp"
#include "host/apps/aspirate/plan_step.hpp"
#include "host/apps/compute_options.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<Option> aspirate_table() {
    return joined(
        {{
             Option::choice("step", {"run", "contours", "fit", "plan"},
                            "run: all of it; contours: from frames to profiles; fit: from profiles "
                            "and suction to tissue; plan: the intervals to expect of a film that "
                            "nobody has taken yet, without frames")
                 .positional()
                 .required(),
             Option::input_file("frames",
                                "Folder of PGM, PNG or TIFF files, in the order of their names; a "
                                "film (.avi, .mp4, ...), read by ffmpeg; -: raw grey bytes on "
                                "standard input (raw). Of fit: the table of profiles that "
                                "contours wrote")
                 .positional(),
             Option::input_file("config",
                                "Settings, TOML: of contours [instrument], [frames]; of fit "
                                "[instrument], [pressure], [tissue]; of run all; of plan "
                                "[supposed], too")
                 .required(),
             Option::input_file(
                 "pressure",
                 "Of run, fit and plan: table of time_s and suction_mbar or suction_kpa, if the "
                 "settings do not have it"),
             Option::text("raw", "Size of raw frames, WIDTHxHEIGHT in pixels"),
             Option::folder("out",
                            "Folder, made new: tables, page, result.json; of contours it may be "
                            "left out, then rows of profiles go to standard output as frames come "
                            "in"),
             Option::flag("overwrite", "Replace an older folder"),
             Option::integer("jobs", 1, 256,
                             "Simulations at the same time (run, fit, plan); default: the cores"),
         },
         tangent_options()});
}

Outcome run_aspirate(const OptionValues& values, const ProgressSink& progress) {
    const std::string step = values.text("step");
    if (step == "plan") {
        if (values.is_given("frames"))
            throw Error(ErrorCode::invalid_argument, "plan takes no frames; leave them out");
        return run_plan(values, progress);
    }
    if (!values.is_given("frames"))
        throw Error(ErrorCode::invalid_argument,
                    step + " needs frames: a folder, a film or a table of profiles");
    if (step == "run") return run_film(values, progress);
    return step == "fit" ? run_fit(values, progress) : run_contours(values, progress);
}

}  // namespace

Application aspirate_application() {
    return {"aspirate", "Tissue that is sucked into a tube and filmed: its profiles, and its law",
            aspirate_table(), run_aspirate};
}

}  // namespace palpate
