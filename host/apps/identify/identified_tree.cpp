// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/identify/identified_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/page/numbers.hpp"
#include "host/page/plain_text.hpp"
#include "host/page/tree_table.hpp"
#include "host/system/version.hpp"

namespace palpate {
namespace {

/// Of what was allowed: then what lies beyond may fit better.
bool stands_at_an_end(const IdentifiedParameter& one) {
    const Parameter& parameter = one.parameter;
    const double room = 1e-3 * std::max(std::abs(one.value), 1e-12);
    return parameter.transform != Transform::logit &&
           ((std::isfinite(parameter.lowest) && parameter.lowest != 0 &&
             one.value - parameter.lowest < room) ||
            (std::isfinite(parameter.highest) && parameter.highest - one.value < room));
}

std::string why_text(const IdentifiedParameter& one) {
    return stands_at_an_end(one) ? "it stands at an end of what was allowed, and what lies beyond "
                                   "may fit better: believe no interval of this run"
                                 : one.judgement.reason;
}

/// `distrust`: of all values; empty: none.
ResultTree parameter_part(const IdentifiedParameter& one, const std::string& path,
                          const std::vector<IdentifiedParameter>& all,
                          const std::string& distrust) {
    ResultTree part{.name = path};
    part.add("path", path);
    part.add(Figure{.name = "number",
                    .value = one.parameter.words.empty() ? path : one.parameter.words,
                    .title = "Number"});
    Figure value{.name = "value", .value = one.value, .title = "Value"};
    value.interval_95 = one.interval;
    value.interval_name = "interval_95";
    if (!one.parameter.is_nuisance) {  // nobody asked for it
        value.verdict = distrust.empty() ? one.judgement.verdict : Verdict::not_judged;
        value.reason = distrust.empty() ? one.judgement.reason : distrust;
    }
    part.add(value);
    part.add(Figure{.name = "unit",
                    .value = one.parameter.unit.empty() ? "1" : one.parameter.unit,
                    .title = "Unit"});
    part.add(Figure{.value = one.parameter.is_held
                                 ? "held at what was told; its error is in all intervals"
                             : one.parameter.is_nuisance ? "expected, with an error"
                             : distrust.empty()          ? why_text(one)
                                                         : distrust,
                    .title = "Why"});
    part.add("is_nuisance", one.parameter.is_nuisance);
    part.add("is_held", one.parameter.is_held);
    part.add("stands_at_an_end", stands_at_an_end(one));
    part.add("scale", name_of(one.parameter.transform));
    part.add("sd_on_scale", one.sd);
    part.add("prior_median", one.parameter.median);
    part.add("prior_sd_on_scale", one.parameter.sd);
    part.add("mesh_shift_on_scale", one.discretisation_shift);
    part.add("mesh_shift_sd", one.discretisation_sd);
    part.add("interval_is_of_profile", one.is_profiled);
    part.add("interval_is_cut", std::vector<std::int64_t>{one.is_cut[0], one.is_cut[1]});
    if (one.partner >= 0) {
        part.add("correlates_most_with", label_of(all.at(one.partner).parameter));
        part.add("correlation", one.partner_correlation);
    }
    return part;
}

ResultTree block_part(const BlockFit& block, double noise_sd) {
    ResultTree part{.name = block.name};
    part.add(Figure{.name = "name", .value = block.name, .title = "Data"});
    part.add(Figure{.name = "kind", .value = block.kind, .title = "Kind"});
    part.add(Figure{.name = "rows", .value = std::int64_t(block.num_row), .title = "Rows"});
    part.add(Figure{.name = "noise_sd", .value = noise_sd, .title = "Noise (sd)"});
    part.add(Figure{.name = "rms", .value = block.rms, .title = "Left unexplained (rms)"});
    part.add(Figure{.name = "discrepancy",
                    .value = block.discrepancy.amplitude,
                    .title = "Model discrepancy (sd)"});
    part.add(Figure{.name = "unit", .value = block.unit, .title = "Unit"});
    part.add("discrepancy_length_mm", block.discrepancy.length_mm);
    part.add("discrepancy_length_s", block.discrepancy.length_s);
    part.add(Figure{.name = "chi_squared", .value = block.chi_squared, .title = "chi squared"});
    part.add("chi_squared_of_noise_alone", block.chi_squared_noise);
    part.add(Figure{.name = "outliers",
                    .value = std::int64_t(block.num_outlier),
                    .title = "Rows that count less"});
    part.add("effective_rows", block.effective_rows);
    return part;
}

std::vector<std::vector<double>> rows_of(const Eigen::MatrixXd& matrix) {
    std::vector<std::vector<double>> rows;
    for (Eigen::Index k = 0; k < matrix.rows(); ++k) {
        const Eigen::RowVectorXd row = matrix.row(k);
        rows.emplace_back(row.begin(), row.end());
    }
    return rows;
}

ResultTree parameters_tree(const IdentifiedExperiment& found) {
    ResultTree list{.name = "parameters",
                    .title = found.is_plan ? "What to expect" : "What was found",
                    .shape = ResultTree::Shape::list};
    const auto& all = found.identified.parameters;
    const std::string distrust = found.is_plan ? "" : found.distrust();
    for (std::size_t k = 0; k < all.size(); ++k)
        list.add(parameter_part(all[k], found.experiment.paths()[k], all, distrust));
    return list;
}

ResultTree blocks_tree(const IdentifiedExperiment& found) {
    ResultTree list{.name = "data",
                    .title = found.is_plan ? "" : "How the data are met",
                    .shape = ResultTree::Shape::list};
    for (std::size_t k = 0; k < found.identified.blocks.size(); ++k)
        list.add(block_part(found.identified.blocks[k], found.fit.prediction->blocks[k].sd.mean()));
    return list;
}

std::string ending_sentence(const IdentifiedExperiment& found) {
    if (found.is_plan)
        return fmt::format("Planned with {} simulations in {:.1f} s; nothing measured was used.",
                           found.num_simulation, found.seconds);
    const std::string distrust = found.distrust();
    if (!found.converged()) return distrust;
    return fmt::format("The search converged, with {} simulations in {:.1f} s.",
                       found.num_simulation, found.seconds) +
           (distrust.empty() ? "" : " " + distrust);
}

}  // namespace

std::string IdentifiedExperiment::distrust() const {
    if (!converged())
        return fmt::format("The search did not converge ({}): do not trust the values.",
                           fit.is_settled ? name_of(fit.ending) : "the discrepancy did not settle");
    return misfit;
}

ResultTree identified_tree(const IdentifiedExperiment& found) {
    const Identified& all = found.identified;
    ResultTree tree{
        .name = "identify",
        .title = found.experiment.title().empty() ? "Identified tissue" : found.experiment.title()};
    tree.add("program", "palpate");
    tree.add("version", version_text());
    tree.add(parameters_tree(found));
    tree.add(blocks_tree(found));
    ResultTree knowledge{.name = "combinations", .title = "Which combinations are known"};
    if (!all.best_known.words.empty())
        knowledge.add(Figure{.name = "best", .value = all.best_known.words, .title = "Known best"});
    if (!all.weakest.words.empty())
        knowledge.add(
            Figure{.name = "weakest", .value = all.weakest.words, .title = "Known least"});
    knowledge.add("singular_values",
                  std::vector<double>(all.singular_values.begin(), all.singular_values.end()));
    knowledge.add("correlation", rows_of(all.correlation));
    tree.add(std::move(knowledge));
    ResultTree search{.name = "search", .title = "Search"};
    search.add(Figure{.name = "ending", .value = ending_sentence(found), .title = "Ending"});
    if (!found.mesh_check_sentence.empty())
        search.add(Figure{.name = "mesh_check",
                          .value = found.mesh_check_sentence,
                          .title = "Mesh and time steps"});
    search.add("mesh_checked", found.is_mesh_checked);
    search.add(Figure{.name = "method", .value = name_of(found.fit.method), .title = "Method"});
    search.add(Figure{
        .name = "log_evidence", .value = all.log_evidence, .title = "ln evidence of this model"});
    search.add(Figure{.name = "bic", .value = all.bic, .title = "BIC"});
    search.add(Figure{.name = "effective_rows",
                      .value = all.effective_rows,
                      .title = "Independent measurements",
                      .decimals = 0});
    search.add("objective", found.fit.objective);
    search.add("simulations", std::int64_t(found.num_simulation));
    search.add("starts", std::int64_t(found.num_start));
    search.add("minima", std::int64_t(found.num_minimum));
    search.add("seconds", found.seconds);
    tree.add(std::move(search));
    tree.add("is_plan", found.is_plan);
    tree.add("converged", found.converged());
    tree.add("distrust", found.is_plan ? std::string() : found.distrust());
    return tree;
}

std::string identified_text(const IdentifiedExperiment& found) {
    std::string out = table_of(parameters_tree(found), {"number", "value", "unit"}, "-").text();
    if (!found.is_plan)
        out += '\n' + table_of(blocks_tree(found),
                               {"name", "kind", "rows", "noise_sd", "rms", "discrepancy", "unit",
                                "outliers"},
                               "-")
                          .text();
    out += '\n';
    if (!found.identified.best_known.words.empty())
        out += harmless(found.identified.best_known.words) + ".\n";
    for (const IdentifiedParameter& one : found.identified.parameters)
        if (stands_at_an_end(one))
            out += "Warning: " + harmless(label_of(one.parameter)) + ": " + why_text(one) + ".\n";
    if (!found.mesh_check_sentence.empty()) out += found.mesh_check_sentence + '\n';
    if (found.num_minimum > 1)
        out += fmt::format("{} starts ended in {} different minima; this is the best.\n",
                           found.num_start, found.num_minimum);
    return out + ending_sentence(found) + '\n';
}

std::string fit_csv(const IdentifiedExperiment& found) {
    std::string out = "data,time_s,x_mm,measured,sd,predicted,unit\n";
    for (const DataBlock& block : found.fit.prediction->blocks)
        for (Eigen::Index row = 0; row < block.num_row(); ++row)
            out += fmt::format(
                "{},{},{},{},{},{},{}\n", csv_text(block.name),
                block.time_s.size() > 0 ? csv_number(block.time_s[row]) : "",
                block.position_mm.size() > 0 ? csv_number(block.position_mm(row, 0)) : "",
                csv_number(block.measured[row]), csv_number(block.sd[row]),
                csv_number(block.predicted[row]), csv_text(block.unit));
    return out;
}

}  // namespace palpate
