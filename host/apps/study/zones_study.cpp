// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/apps/phantom/random_numbers.hpp"
#include "host/apps/recover/report/findings.hpp"
#include "host/apps/study/figures.hpp"
#include "host/apps/study/pelvis_case.hpp"
#include "host/apps/study/statistics.hpp"
#include "host/apps/study/tables.hpp"
#include "host/page/numbers.hpp"
#include "host/page/plot.hpp"

namespace palpate {
namespace {

constexpr double aim_percent = 15;   // error of a zone that is called recovered
constexpr double narrow_span = 1.5;  // of an interval that promises about that
constexpr double rigid_kpa = 5000;   // 500 times the surroundings: no wall here can deform it
constexpr int seeds_per_trap = 2;
const std::array<std::string, 2> zones{"transition", "peripheral"};

/// What a phantom was built for: to be recovered, or to leave a modulus open.
enum class Kind { two_zones, still, rigid, rigid_core };
constexpr std::array<Kind, 3> traps{Kind::still, Kind::rigid, Kind::rigid_core};

const char* name_of(Kind kind) {
    constexpr std::array<const char*, 4> names{"two-zones", "still", "rigid", "rigid-core"};
    return names[std::size_t(kind)];
}

const char* about(Kind kind) {
    constexpr std::array<const char*, 4> texts{
        "both zones deform", "nothing moves between the two states",
        "both zones are 500 times stiffer than their surroundings and move as one rigid body",
        "the transition zone is 500 times stiffer than the surroundings"};
    return texts[std::size_t(kind)];
}

/// Of transition and peripheral zone: log-uniform from 40 to 350 kPa, each for itself.
std::array<double, 2> drawn_zones_kpa(unsigned seed) {
    RandomNumbers random(0x7a6b7061ull * 1000003ull + seed);
    std::array<double, 2> kpa{};
    for (double& value : kpa)
        value = std::round(10 * std::exp(random.uniform(std::log(40.0), std::log(350.0)))) / 10;
    return kpa;
}

PelvisCase pelvis_case(Kind kind, unsigned seed, const StudyOptions& options) {
    std::array<double, 2> kpa = drawn_zones_kpa(seed);
    if (kind == Kind::rigid) kpa = {rigid_kpa, rigid_kpa};
    if (kind == Kind::rigid_core) kpa[0] = rigid_kpa;
    PelvisCase work;
    work.truth = pelvis_options(options, seed, PelvisOptions{}.stiffness_kpa);
    work.truth.zone_stiffness_kpa = kpa;
    if (kind == Kind::still) work.truth.load_factor = 0;
    return work;
}

void set_zone(Row& row, const std::string& zone, double truth_kpa, const RecoveryResult& result) {
    const auto found =
        std::find_if(result.regions.begin(), result.regions.end(),
                     [&](const RegionResult& region) { return region.name == zone + "_zone"; });
    const auto& [low, high] = found->interval_kpa;
    row.set(zone + "_true_kpa", truth_kpa, 1);
    row.set(zone + "_found_kpa", found->stiffness_kpa, 2);
    row.set(zone + "_error_percent", 100 * (found->stiffness_kpa / truth_kpa - 1), 1);
    row.set(zone + "_low_kpa", low, 2);
    row.set(zone + "_high_kpa", high, 2);
    row.set_flag(zone + "_holds_truth", low <= truth_kpa && truth_kpa <= high);
    row.set(zone + "_verdict", std::string(name_of(found->verdict)));
    row.set(zone + "_reason", found->reason);
}

Row row_of(Kind kind, const PelvisCase& work, const PelvisOutcome& outcome) {
    const RecoveryResult& result = outcome.result;
    Row row;
    row.set("kind", name_of(kind));
    row.set("seed", work.truth.seed, 0);
    for (std::size_t z = 0; z < zones.size(); ++z)
        set_zone(row, zones[z], work.truth.zone_stiffness_kpa->at(z), result);
    row.set("correlation", result.correlation.at(0).at(1), 3);
    row.set("least_singular_value", result.sensitivity.back().singular_value, 3);
    row.set("landmark_mean_mm",
            mean_of(landmark_errors_mm(outcome.phantom, result.displacement_field)), 3);
    row.set_flag("converged", result.termination.converged);
    row.set("iterations", result.termination.iterations, 0);
    row.set("seconds", total_seconds(result), 1);
    return row;
}

std::vector<std::string> zone_columns() {
    std::vector<std::string> columns{"kind", "seed"};
    for (const std::string& zone : zones)
        for (const char* value : {"true_kpa", "found_kpa", "error_percent", "low_kpa", "high_kpa",
                                  "holds_truth", "verdict", "reason"})
            columns.push_back(zone + "_" + value);
    for (const char* name : {"correlation", "least_singular_value", "landmark_mean_mm", "converged",
                             "iterations", "seconds"})
        columns.push_back(name);
    return columns;
}

Estimate estimate_of(const Row& row, const std::string& zone) {
    return {row.number(zone + "_true_kpa"),
            row.number(zone + "_found_kpa"),
            {row.number(zone + "_low_kpa"), row.number(zone + "_high_kpa")},
            verdict_in(row, zone + "_verdict")};
}

std::vector<Row> rows_of(const std::vector<Row>& rows, bool built_to_be_recovered) {
    std::vector<Row> some;
    for (const Row& row : rows)
        if ((row.text("kind") == name_of(Kind::two_zones)) == built_to_be_recovered)
            some.push_back(row);
    return some;
}

/// Of these rows, by zone; both zones for an empty `zone`, one verdict or all of them.
std::vector<Estimate> estimates(const std::vector<Row>& rows, const std::string& zone,
                                std::optional<Verdict> verdict = std::nullopt) {
    std::vector<Estimate> some;
    for (const Row& row : rows)
        for (const std::string& name : zones) {
            const Estimate estimate = estimate_of(row, name);
            if (!zone.empty() && zone != name) continue;
            if (!verdict || verdict == estimate.verdict) some.push_back(estimate);
        }
    return some;
}

std::size_t num_within_aim(const std::vector<Estimate>& some) {
    return std::count_if(some.begin(), some.end(), [](const Estimate& estimate) {
        return std::abs(estimate.error_percent()) <= aim_percent;
    });
}

std::vector<std::string> error_line(const std::string& name, const std::vector<Estimate>& some) {
    const Accuracy group = accuracy_of(name, some);
    return {name,
            fmt::format("{}", some.size()),
            fmt::format("{}", num_within_aim(some)),
            percent(group.median_abs_error_percent),
            signed_percent(group.mean_signed_error_percent),
            percent(group.worst_abs_error_percent),
            holding_text(group)};
}

/// One line per verdict and zone, and one of the narrowest intervals.
StudyTable verdict_table(const std::vector<Row>& rows) {
    StudyTable table{{"zone and verdict", "zones", "within 15 %", "median |error|", "mean error",
                      "worst |error|", "intervals that hold the truth"},
                     {}};
    for (const std::string& zone : {zones[0], zones[1], std::string()})
        for (const Verdict verdict :
             {Verdict::recovered, Verdict::weak, Verdict::not_identifiable}) {
            const auto some = estimates(rows, zone, verdict);
            if (some.empty()) continue;
            table.lines.push_back(
                error_line((zone.empty() ? "both" : zone) + ", " + name_of(verdict), some));
        }
    auto narrow = estimates(rows, "", Verdict::recovered);
    std::erase_if(narrow, [](const Estimate& estimate) {
        return !(estimate.interval_kpa[1] < narrow_span * estimate.interval_kpa[0]);
    });
    if (!narrow.empty())
        table.lines.push_back(
            error_line(fmt::format("both, interval below a factor of {}", narrow_span), narrow));
    return table;
}

StudyTable trap_table(const std::vector<Row>& rows) {
    StudyTable table{{"phantom", "zone", "true E, kPa", "verdict", "95 % interval, kPa",
                      "holds the truth", "least singular value"},
                     {}};
    for (const Row& row : rows)
        for (const std::string& zone : zones) {
            const Estimate found = estimate_of(row, zone);
            table.lines.push_back(
                {row.text("kind") + ", seed " + row.text("seed"), zone,
                 significant(found.expected_kpa), found.verdict ? name_of(*found.verdict) : "",
                 significant(found.interval_kpa[0]) + " to " + significant(found.interval_kpa[1]),
                 row.text(zone + "_holds_truth"), row.text("least_singular_value")});
        }
    return table;
}

/// Errors of one zone over those of the other: moduli that trade lie along a falling line.
StudyPicture errors_picture(const std::vector<Row>& rows) {
    std::vector<double> transition, peripheral;
    double reach = 1.6 * aim_percent;
    for (const Row& row : rows) {
        transition.push_back(row.number("transition_error_percent"));
        peripheral.push_back(row.number("peripheral_error_percent"));
        for (const double error : {transition.back(), peripheral.back()})
            if (std::isfinite(error)) reach = std::max(reach, 1.1 * std::abs(error));
    }
    const double low = std::max(-100.0, -reach);
    Plot plot("zones", 440, 380, {low, reach, false, "error of the transition zone, %"},
              {low, reach, false, "error of the peripheral zone, %"});
    const std::vector<double> square{-aim_percent, aim_percent, aim_percent, -aim_percent,
                                     -aim_percent};
    plot.guide(square, {-aim_percent, -aim_percent, aim_percent, aim_percent, -aim_percent}, "");
    plot.points(transition, peripheral, our_colour, false);
    return {"zones", plot.svg("Error of one zone over that of the other"),
            legend_html({{"one phantom", our_colour}}),
            "Errors of both zones of each phantom. Dashed: 15 %. Moduli that trade with each other "
            "would lie along a falling line."};
}

/// Verdicts on the moduli that cannot be found: all of a trap's but that of tissue which deforms
/// round a rigid core.
std::vector<Verdict> verdicts_on_open_moduli(const std::vector<Row>& rows) {
    std::vector<Verdict> verdicts;
    for (const Row& row : rows)
        for (const std::string& zone : zones) {
            if (row.text("kind") == name_of(Kind::rigid_core) && zone == "peripheral") continue;
            if (const auto verdict = estimate_of(row, zone).verdict) verdicts.push_back(*verdict);
        }
    return verdicts;
}

std::string trap_captions() {
    std::string out = "<p class='caption'>";
    for (const Kind kind : traps) out += fmt::format("<b>{}</b>: {}. ", name_of(kind), about(kind));
    return out +
           "An honest verdict is <i>not identifiable</i>, or <i>weak</i> with a lower bound where "
           "an organ is too stiff to deform.</p>";
}

StudyReport zones_report(const std::vector<Row>& rows) {
    const auto two_zones = rows_of(rows, true), trapped = rows_of(rows, false);
    const auto all = estimates(two_zones, ""),
               recovered = estimates(two_zones, "", Verdict::recovered);
    const auto open = verdicts_on_open_moduli(trapped);
    const auto num_called = [&](Verdict verdict) {
        return std::count(open.begin(), open.end(), verdict);
    };
    const Accuracy accuracy = accuracy_of("two zones", all);
    const std::size_t within = num_within_aim(recovered);

    StudyReport report;
    report.headline =
        fmt::format("Two zones: {} of {} that are called recovered lie within {:.0f} %", within,
                    recovered.size(), aim_percent);
    report.sentences = {
        fmt::format("The prostate of {} phantom{} has two zones with labels, each with a stiffness "
                    "of its own between 40 and 350 kPa; both are unknown. {} intervals hold the "
                    "truth.",
                    two_zones.size(), two_zones.size() == 1 ? "" : "s", holding_text(accuracy)),
        fmt::format("{} more were built so that some modulus cannot be found. Of {} such moduli "
                    "{} are called not identifiable and {} weak; {} intervals of these phantoms "
                    "hold the truth.",
                    trapped.size(), open.size(), num_called(Verdict::not_identifiable),
                    num_called(Verdict::weak),
                    holding_text(accuracy_of("", estimates(trapped, ""))))};
    report.sections = {
        {"Truth and estimate",
         verdict_table(two_zones).html("beside"),
         {recovered_picture(all, {}, "true E of a zone, kPa"), errors_picture(two_zones)}},
        {"Built to be unidentifiable", trap_table(trapped).html("beside") + trap_captions(), {}}};
    report.facts = facts_of({accuracy, accuracy_of("recovered", recovered)});
    report.facts.emplace_back("recovered: within_15_percent", double(within));
    report.facts.emplace_back("open moduli", double(open.size()));
    report.facts.emplace_back("open moduli: not_identifiable",
                              num_called(Verdict::not_identifiable));
    report.facts.emplace_back("open moduli: weak", num_called(Verdict::weak));
    report.text = verdict_table(two_zones).plain() + "\n" + trap_table(trapped).plain();
    return report;
}

}  // namespace

Study make_zones_study(const StudyOptions& options) {
    Study study{
        "zones",     "Two zones of unknown stiffness", pelvis_settings(options), zone_columns(), {},
        zones_report};
    const auto add = [&](Kind kind, unsigned seed) {
        study.cases.push_back(
            {fmt::format("{}-seed-{}", name_of(kind), seed),
             fmt::format("{}, seed {}", name_of(kind), seed), [=](const ProgressSink& progress) {
                 const PelvisCase work = pelvis_case(kind, seed, options);
                 return row_of(kind, work, run_pelvis_case(work, options, progress));
             }});
    };
    for (int k = 0; k < options.phantoms; ++k)
        add(Kind::two_zones, options.first_seed + unsigned(k));
    for (const Kind kind : traps)
        for (int k = 0; k < std::min(options.phantoms, seeds_per_trap); ++k)
            add(kind, options.first_seed + unsigned(k));
    return study;
}

}  // namespace palpate
