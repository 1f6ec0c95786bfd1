// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/recover/pipeline/poisson_ratios.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/apps/recover/modelling/regions.hpp"
#include "host/apps/recover/pipeline/recover_options.hpp"

namespace palpate {
namespace {

bool is_same_noise(const NoiseLevel& a, const NoiseLevel& b) {
    constexpr double allowed_change = 0.1, allowed_change_mm = 0.02;
    return std::abs(std::log(a.scale / b.scale)) < allowed_change &&
           std::abs(a.contour_mm - b.contour_mm) <
               allowed_change_mm + allowed_change * b.contour_mm;
}

/// Objectives of trials are compared with each other, so each search must end closer to its minimum
/// than one whose moduli alone matter.
constexpr double objective_tolerance_per_row = 1e-4;
constexpr double modulus_tolerance_sd = 0.1;  // trials compare objectives
/// For the same reason less is left out of the response model.
constexpr double response_refinement = 0.3;

std::vector<Index> influential_ratios(const Mechanics& mechanics) {
    std::vector<Index> regions;
    for (const Index region : mechanics.recovery.unknown_ratio) {
        const auto& seen = mechanics.response.regions();
        if (std::any_of(seen.begin(), seen.end(),
                        [&](const auto& part) { return part.region == region; })) {
            regions.push_back(region);
        }
    }
    return regions;
}

std::shared_ptr<const Mechanics> with_ratios(const Mechanics& start,
                                             const std::vector<Index>& regions,
                                             const Eigen::VectorXd& ratios,
                                             const RecoverOptions& options) {
    RecoveryModel recovery = start.recovery;
    for (std::size_t k = 0; k < regions.size(); ++k) {
        set_poisson_ratio(recovery.model, regions[k], ratios[static_cast<Index>(k)]);
    }
    StageTimer unused;
    MechanicsOptions finer = options.mechanics;
    finer.response.tolerance_mm *= response_refinement;
    return std::make_shared<Mechanics>(
        make_mechanics(std::move(recovery), options.settings.prior, options.solver, finer, unused));
}

class RatioSearch {
public:
    RatioSearch(const Mechanics& start, const SurfaceObservations& observations,
                const RecoverOptions& options, const ProgressSink& progress)
        : start_(start),
          observations_(observations),
          options_(options),
          progress_(progress),
          regions_(influential_ratios(start)) {}

    PoissonEstimate run();

private:
    Eigen::VectorXd assumed_ratios() const;
    RatioTrial evaluate(const Eigen::VectorXd& ratios);
    RatioPosterior search(const Eigen::VectorXd& ratios);
    RatioSearchOptions bounds() const;
    MapEstimate estimate_at(const Mechanics& mechanics) const;
    void report(const RatioTrial& trial) const;

    const Mechanics& start_;
    const SurfaceObservations& observations_;
    const RecoverOptions& options_;
    const ProgressSink& progress_;
    std::vector<Index> regions_;
    MapEstimate last_;  ///< of the latest trial
    std::shared_ptr<const Mechanics> best_mechanics_;
    double lowest_ = 0;
    bool is_best_settled_ = false;
    int trials_ = 0;
};

Eigen::VectorXd RatioSearch::assumed_ratios() const {
    Eigen::VectorXd ratios(regions_.size());
    for (std::size_t k = 0; k < regions_.size(); ++k) {
        ratios[static_cast<Index>(k)] = poisson_ratio(start_.recovery.model, regions_[k]);
    }
    return ratios;
}

void RatioSearch::report(const RatioTrial& trial) const {
    std::string text;
    for (std::size_t k = 0; k < regions_.size(); ++k) {
        text += fmt::format(" {} {:.3f},", name_of_region(options_.settings, regions_[k]),
                            trial.ratios[static_cast<Index>(k)]);
    }
    for (Index k = 0; k < trial.theta.size(); ++k) {
        text += fmt::format(" {:.4g} kPa,", std::exp(trial.theta[k]));
    }
    report_progress(progress_, "searching", -1,
                    fmt::format("Poisson's ratios, trial {}:{} objective {:.2f}", trials_, text,
                                trial.objective));
}

RatioTrial RatioSearch::evaluate(const Eigen::VectorXd& ratios) {
    const auto mechanics = with_ratios(start_, regions_, ratios, options_);
    MapOptions search = options_.search;
    search.objective_tolerance_per_row =
        std::min(search.objective_tolerance_per_row, objective_tolerance_per_row);
    search.modulus_tolerance_sd = std::max(search.modulus_tolerance_sd, modulus_tolerance_sd);
    last_ = map_estimate_from(last_, mechanics->response, mechanics->walls, observations_,
                              mechanics->unknowns, search);
    last_.posterior.reset();  // points into these mechanics
    if (!best_mechanics_ || last_.objective < lowest_) {
        best_mechanics_ = mechanics;
        lowest_ = last_.objective;
        is_best_settled_ = last_.termination.converged;
    }
    ++trials_;
    RatioTrial trial{ratios, last_.objective, last_.theta};
    report(trial);
    return trial;
}

RatioPosterior RatioSearch::search(const Eigen::VectorXd& ratios) {
    best_mechanics_.reset();
    return search_ratios([this](const Eigen::VectorXd& trial) { return evaluate(trial); }, ratios,
                         bounds());
}

RatioSearchOptions RatioSearch::bounds() const {
    RatioSearchOptions bounds;
    bounds.lowest = options_.settings.prior.poisson_lowest;
    bounds.highest = options_.settings.prior.poisson_highest;
    bounds.first_step = (bounds.highest - bounds.lowest) / 3.0;
    return bounds;
}

MapEstimate RatioSearch::estimate_at(const Mechanics& mechanics) const {
    return map_estimate(mechanics.response, mechanics.walls, observations_, mechanics.unknowns,
                        options_.search, progress_);
}

/// The moduli as uncertain as the ratios make them: mixed over the posterior of each ratio.
void widen(MapEstimate& estimate, const std::vector<RatioScan>& scans) {
    for (const RatioScan& scan : scans) {
        const RatioMixture mixture = mixture_of(scan, ratio_model_sd);
        const Eigen::MatrixXd added = spread_of(mixture);
        estimate.covariance += added;
        for (std::size_t k = 0; k < estimate.unknown.size(); ++k) {
            const Index row = static_cast<Index>(k);
            const double sd_ln = std::sqrt(added(row, row));
            estimate.seen_sd_ln[row] = std::hypot(estimate.seen_sd_ln[row], sd_ln);
            estimate.interval_kpa[k] = mixed_interval(mixture, row, estimate.interval_kpa[k],
                                                      std::exp(estimate.theta[row]));
        }
    }
}

PoissonEstimate RatioSearch::run() {
    PoissonEstimate found;
    found.regions = regions_;
    if (regions_.empty()) {
        found.mechanics = std::make_shared<Mechanics>(start_);
        found.estimate = estimate_at(*found.mechanics);
        return found;
    }
    found.estimate = estimate_at(start_);
    Eigen::VectorXd ratios = assumed_ratios();
    bool is_noise_agreed = false;
    for (int pass = 0; pass < 2 && !is_noise_agreed; ++pass) {
        last_ = found.estimate;
        found.ratios = search(ratios);
        found.mechanics = best_mechanics_;
        const NoiseLevel held = found.estimate.noise_level;
        found.estimate = estimate_at(*found.mechanics);
        is_noise_agreed = is_same_noise(found.estimate.noise_level, held);
        ratios = found.ratios.best.ratios;
    }
    const bool is_settled = found.ratios.converged && is_best_settled_ && is_noise_agreed;
    last_ = found.estimate;  // its noise is held
    widen(found.estimate,
          scan_ratios([this](const Eigen::VectorXd& trial) { return evaluate(trial); },
                      found.ratios, bounds()));
    if (!is_settled) {
        found.estimate.termination.converged = false;
        found.estimate.termination.reason =
            fmt::format("the search of Poisson's ratios did not settle in {} trials; {}", trials_,
                        found.estimate.termination.reason);
    }
    return found;
}

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
    throw Error(ErrorCode::invalid_argument,
                option + " does not go with poisson_ratio = \"unknown\": " + why +
                    "; give the ratios as numbers");
}

}  // namespace

PoissonEstimate search_poisson_ratios(const Mechanics& start,
                                      const SurfaceObservations& observations,
                                      const RecoverOptions& options, const ProgressSink& progress) {
    return RatioSearch(start, observations, options, progress).run();
}

void check_unknown_ratios(const RecoverOptions& options) {
    if (!options.settings.has_unknown_poisson_ratio()) return;
    if (options.method == SearchMethod::nested_lbfgs) {
        refuse("--method nested-lbfgs", "the published method searches moduli only");
    }
    const std::string why = "a reduced model holds for one set of ratios";
    if (!options.save_reduced.empty()) refuse("--save-reduced", why);
    if (!options.load_reduced.empty()) refuse("--load-reduced", why);
}

}  // namespace palpate
