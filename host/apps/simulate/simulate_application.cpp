// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/simulate/simulate_application.hpp"

#include <fmt/core.h>

#include "host/apps/compute_options.hpp"
#include "host/apps/simulate/simulation_findings.hpp"
#include "host/apps/simulate/simulation_folder.hpp"
#include "host/apps/simulate/simulation_tree.hpp"
#include "solver/base/error.hpp"

namespace palpate {
namespace {

std::vector<Option> simulate_table() {
    return joined(
        {{
             Option::input_file("model", "Mesh, tissues and loads (TOML)").positional().required(),
             Option::folder("out", "Result folder, made new").required(),
             Option::flag("overwrite", "Replace an older result folder"),
         },
         tangent_options()});
}

Outcome run_simulate(const OptionValues& values, const ProgressSink& progress) {
    const std::filesystem::path folder = values.path("out");
    const bool overwrite = values.flag("overwrite");
    check_simulation_folder(folder, overwrite);
    SimulationSettings settings = read_simulation(values.path("model"));
    take_tangent_options(values, settings.newton);
    const SimulationResult result = run_simulation(settings, progress);
    report_progress(progress, "writing", 0, "result folder");
    write_simulation(result, folder, overwrite);
    Outcome outcome{simulation_tree(result)};
    for (const std::string& sentence : simulation_sentences(result))
        outcome.text += sentence + '\n';
    outcome.text += fmt::format("report: {}/report.html\n", folder.string());
    outcome.exit_code = result.converged() ? 0 : exit_code_not_converged;
    return outcome;
}

}  // namespace

Application simulate_application() {
    return {"simulate", "Deform a body of known tissue: forces and displacements in, fields out",
            simulate_table(), run_simulate};
}

}  // namespace palpate
