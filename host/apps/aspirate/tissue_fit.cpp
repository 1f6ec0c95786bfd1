// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_fit.hpp"

#include "host/apps/aspirate/fit_page.hpp"
#include "host/apps/aspirate/tissue_models.hpp"
#include "host/apps/identify/identified_tree.hpp"
#include "host/io/output_folder.hpp"
#include "host/page/tree_json.hpp"
#include "host/system/exit_codes.hpp"
#include "solver/base/error.hpp"

namespace palpate {

namespace fs = std::filesystem;

Suction suction_from(const OptionValues& values, const AspirationSettings& settings) {
    if (values.is_given("pressure") == settings.suction.has_value())
        throw Error(ErrorCode::invalid_argument,
                    settings.suction ? "suction is given twice; leave out --pressure, or the "
                                       "readings in [pressure]"
                                     : "there is no suction; give --pressure, or readings in "
                                       "[pressure]");
    return settings.suction ? *settings.suction : read_suction(values.path("pressure"));
}

Outcome fit_tissue(const AspirationSettings& settings, const Suction& suction,
                   const AspirationFitInput& input, const FilmOutlines* film,
                   const fs::path& inside, const OptionValues& values,
                   const ProgressSink& progress) {
    write_text_file(inside / points_file, input.points_csv());
    const AspirationFit all = fit_models(settings, input, suction, inside, values, progress);
    const TriedModel& best = all.best();
    write_text_file(inside / "experiment.toml", best.experiment_toml);
    write_text_file(inside / "identified.toml",
                    best.experiment->model_text(best.found->fit.values, inside));
    write_text_file(inside / "fit.csv", fit_csv(*best.found));
    Outcome outcome{.result = fit_tree(all)};
    if (film) outcome.result.add(outlines_tree(*film, settings.instrument));
    write_text_file(inside / fit_result_file, tree_json(outcome.result));
    write_text_file(inside / "report.html", fit_page(all, outcome.result, film));
    outcome.text = fit_text(all);
    outcome.exit_code = best.found->distrust().empty() ? 0 : exit_code_not_converged;
    return outcome;
}

}  // namespace palpate
