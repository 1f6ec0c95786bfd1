// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/aspirate/tissue_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "host/apps/aspirate/tissue_candidate.hpp"
#include "host/apps/aspirate/tissue_misfit.hpp"
#include "host/apps/compute_options.hpp"
#include "host/apps/identify/mesh_check.hpp"
#include "host/estimate/model_choice.hpp"
#include "solver/base/error.hpp"
#include "solver/base/serial_blas.hpp"
#include "solver/base/tasks.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Of each number of the tissue: what outlines, the guess of the rest and contact at the rim leave
/// that no residual shows. Of films, those of another solver too (docs/aspiration.md).
constexpr double model_sd_ln = 0.02, model_sd_ln_of_stiffening = 0.04;

/// Of ln evidence: a law that is so far behind another one, each with the first number of
/// relaxation terms that is tried, is not tried with others, near the optima and where evidence can
/// be compared. Of 100 tissues (docs/aspiration_studies.md) none had its law farther behind than by
/// 1.3 with one term; with none, which tissue that relaxes is far from, one was by 56.
constexpr double most_behind_near = 100, most_behind = 30;
/// Of ln evidence by coarse cells: differences that the ends of the searches may turn round, of two
/// laws, and of one law with more terms and with fewer.
constexpr double apart_of_laws = 5, apart_of_terms = 0.5;

/// Fits every model as far as it takes to tell which is the best.
class ModelFits {
public:
    ModelFits(const AspirationSettings& settings, const AspirationFitInput& input,
              const Suction& suction, const fs::path& inside, const OptionValues& values,
              const ProgressSink& progress);

    AspirationFit run();

private:
    TissueModel model_of(const std::string& law, int num_terms) const;
    std::optional<std::size_t> simpler_than(std::size_t k) const;
    bool is_first_of_law(std::size_t k) const;
    bool is_behind(const std::string& law, double TissueCandidate::*evidence, double most) const;
    template <typename Work>
    void attempt(TissueCandidate& one, Work&& work);
    void take(TissueCandidate& one);
    void approach(std::size_t k);
    void compare_first(TissueCandidate& one);
    void compare(std::size_t k);
    void find_leader();
    template <typename IsDone>
    void wait_until(IsDone&& is_done);
    void compare_all();
    void compare_dropped();
    std::vector<std::size_t> worth_finding() const;
    void find_best();
    void judge(TissueCandidate& one);
    void rethrow_failure() const;

    std::function<void(SimulationSettings&)> configure_;
    fs::path inside_;
    int jobs_;
    SharedProgress shared_;
    AspirationFit all_;
    double travel_mm_;
    std::vector<TissueCandidate> candidates_;
    /// Of `candidates_`, the fewest relaxation terms first, but none of them last.
    std::vector<std::size_t> order_;
};

ModelFits::ModelFits(const AspirationSettings& settings, const AspirationFitInput& input,
                     const Suction& suction, const fs::path& inside, const OptionValues& values,
                     const ProgressSink& progress)
    : configure_(
          [values](SimulationSettings& model) { take_tangent_options(values, model.newton); }),
      inside_(inside),
      jobs_(jobs_of(values)),
      shared_(progress),
      all_{settings, input, suction, {}},
      travel_mm_(*std::max_element(input.apex.travel_mm.begin(), input.apex.travel_mm.end())) {
    for (const std::string& law : settings.laws)
        for (const int num_terms : settings.relaxation_terms) {
            TissueCandidate one{law, num_terms};
            one.tried.name = name_of_model(law, num_terms);
            one.search = std::make_unique<TissueSearch>(model_of(law, num_terms), shared_.sink());
            candidates_.push_back(std::move(one));
        }
    for (std::size_t k = 0; k < candidates_.size(); ++k) order_.push_back(k);
    const auto rank = [&](std::size_t k) {
        const int num_terms = candidates_[k].num_terms;
        return num_terms > 0 ? num_terms : std::numeric_limits<int>::max();
    };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
}

TissueModel ModelFits::model_of(const std::string& law, int num_terms) const {
    return {.settings = all_.settings,
            .input = all_.input,
            .suction = all_.suction,
            .name = name_of_model(law, num_terms),
            .law = law,
            .num_terms = num_terms,
            .inside = inside_,
            .solving = {configure_, all_.input.start.peak_stiffness_kpa, jobs_},
            .model_sd = model_sds,
            .is_no_model = [travel_mm = travel_mm_](const Fit& fit) {
                return is_no_model(fit, travel_mm);
            }};
}

/// The one of its law with the most relaxation terms that are fewer, one at least.
std::optional<std::size_t> ModelFits::simpler_than(std::size_t k) const {
    const TissueCandidate& one = candidates_[k];
    std::optional<std::size_t> simpler;
    for (std::size_t n = 0; n < candidates_.size(); ++n) {
        const TissueCandidate& other = candidates_[n];
        if (other.law == one.law && other.num_terms >= 1 && other.num_terms < one.num_terms &&
            (!simpler || other.num_terms > candidates_[*simpler].num_terms))
            simpler = n;
    }
    return simpler;
}

bool ModelFits::is_first_of_law(std::size_t k) const {
    for (const std::size_t other : order_)
        if (candidates_[other].law == candidates_[k].law) return other == k;
    return false;
}

/// By the first of each law, if it can be solved.
bool ModelFits::is_behind(const std::string& law, double TissueCandidate::*evidence,
                          double most) const {
    double own = infinite_evidence, highest = -infinite_evidence;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
        if (!is_first_of_law(k) || !candidates_[k].search) continue;
        if (candidates_[k].law == law) own = candidates_[k].*evidence;
        if (std::isfinite(candidates_[k].*evidence))
            highest = std::max(highest, candidates_[k].*evidence);
    }
    return own < highest - most;
}

/// What the search knows.
void ModelFits::take(TissueCandidate& one) {
    SearchedTissue searched = one.search->found();
    TriedModel& tried = one.tried;
    tried.experiment_toml = std::move(searched.experiment_toml);
    tried.experiment = std::move(searched.experiment);
    tried.found = std::make_shared<IdentifiedExperiment>(
        IdentifiedExperiment{.experiment = *tried.experiment});
    IdentifiedExperiment& found = *tried.found;
    found.fit = std::move(searched.fit);
    found.identified = std::move(searched.identified);
    found.num_simulation = searched.num_simulation;
    if (found.fit.prediction) found.misfit = misfit_of(found.fit, travel_mm_);
}

/// One model that cannot be solved is no reason to lose the others.
template <typename Work>
void ModelFits::attempt(TissueCandidate& one, Work&& work) {
    if (!one.search) return;
    // its matrices are small; threads of two fits would wait for each other
    const SerialBlas serial;
    try {
        work(*one.search);
        take(one);
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        one.failure = std::current_exception();
        one.why_failed = error.what();
        one.search = nullptr;
    }
}

/// From where the model with fewer relaxation terms ended.
void ModelFits::approach(std::size_t k) {
    const std::optional<std::size_t> simpler = simpler_than(k);
    candidates_[k].search->approach(simpler ? candidates_[*simpler].search.get() : nullptr);
}

/// From near the optimum to where evidence can be compared.
void ModelFits::compare_first(TissueCandidate& one) {
    if (is_behind(one.law, &TissueCandidate::evidence_near, most_behind_near)) {
        one.tried.progress = ModelProgress::far_behind;
        return;
    }
    one.tried.progress = ModelProgress::compared;
    attempt(one, [&](TissueSearch& search) {
        one.can_tell = search.settle();
        search.weigh();
    });
    if (one.is_compared()) one.evidence_compared = one.log_evidence();
}

/// To where evidence can be compared, from where the simpler one came to.
void ModelFits::compare(std::size_t k) {
    TissueCandidate& one = candidates_[k];
    if (is_behind(one.law, &TissueCandidate::evidence_near, most_behind_near) ||
        is_behind(one.law, &TissueCandidate::evidence_compared, most_behind)) {
        one.tried.progress = ModelProgress::not_fitted;
        return;
    }
    one.tried.progress = ModelProgress::compared;
    attempt(one, [&](TissueSearch& search) {
        approach(k);
        one.can_tell = search.settle();
        search.weigh();
    });
}

/// The best of the first ones is mostly what is preferred in the end, so that it goes on while
/// others are compared. They may begin where it was: `find` leaves that alone.
void ModelFits::find_leader() {
    TissueCandidate* leader = nullptr;
    for (TissueCandidate& one : candidates_)
        if (std::isfinite(one.evidence_compared) && one.tried.found->misfit.empty() &&
            (!leader || one.evidence_compared > leader->evidence_compared))
            leader = &one;
    if (!leader) return;
    const SerialBlas serial;
    try {
        leader->search->find(true);
        leader->is_found = true;
    } catch (const Error& error) {
        if (!is_of_model(error)) throw;
        leader->failure = std::current_exception();
        leader->why_failed = error.what();
    }
}

/// Asks meanwhile whether to stop: whoever is waited for may never begin then.
template <typename IsDone>
void ModelFits::wait_until(IsDone&& is_done) {
    constexpr std::chrono::milliseconds between{20};
    while (!is_done()) {
        check_cancelled(shared_.sink());
        std::this_thread::sleep_for(between);
    }
}

/// The first of each law tells whether others of it are worth it.
void ModelFits::compare_all() {
    std::vector<std::size_t> firsts, others;
    for (const std::size_t k : order_) (is_first_of_law(k) ? firsts : others).push_back(k);
    const std::size_t num_first = firsts.size();
    std::atomic<std::size_t> num_near = 0, num_compared = 0;
    std::vector<std::atomic<bool>> is_done(candidates_.size());
    run_tasks(2 * num_first + 1 + others.size(), jobs_, shared_, [&](std::size_t n) {
        if (n < num_first) {
            TissueCandidate& one = candidates_[firsts[n]];
            attempt(one, [&](TissueSearch& search) {
                approach(firsts[n]);
                one.can_tell = true;
                search.weigh();
            });
            if (one.is_compared()) one.evidence_near = one.log_evidence();
            ++num_near;
            return;
        }
        wait_until([&] { return num_near == num_first; });
        if (n < 2 * num_first) {
            compare_first(candidates_[firsts[n - num_first]]);
            ++num_compared;
            return;
        }
        wait_until([&] { return num_compared == num_first; });
        if (n == 2 * num_first) {
            find_leader();
            return;
        }
        const std::size_t k = others[n - 2 * num_first - 1];
        const auto simpler = simpler_than(k);
        if (simpler && !is_first_of_law(*simpler))
            wait_until([&] { return is_done[*simpler].load(); });
        compare(k);
        is_done[k] = true;
    });
}

/// Laws that were far behind one that could not be solved in the end.
void ModelFits::compare_dropped() {
    for (const std::size_t k : order_) {
        TissueCandidate& one = candidates_[k];
        if (!one.search) continue;
        if (one.tried.progress == ModelProgress::far_behind)
            compare_first(one);
        else if (one.tried.progress == ModelProgress::not_fitted)
            compare(k);
    }
}

/// Those that may be preferred (`preferred_model`) once they are at their ends. What nobody will
/// believe is none of them if there is anything else.
std::vector<std::size_t> ModelFits::worth_finding() const {
    const auto is_finished = [](const TissueCandidate& one) {
        return one.is_compared() && one.tried.progress == ModelProgress::finished;
    };
    const bool is_any_finished = std::any_of(candidates_.begin(), candidates_.end(), is_finished);
    const auto has_a_chance = [&](const TissueCandidate& one) {
        if (!one.is_compared()) return false;
        if (is_finished(one)) return one.tried.found->distrust().empty();
        return one.tried.progress == ModelProgress::compared &&
               (!is_any_finished || one.tried.found->misfit.empty());
    };
    double highest = -infinite_evidence;
    for (const TissueCandidate& one : candidates_)
        if (has_a_chance(one) && std::isfinite(one.log_evidence()))
            highest = std::max(highest, one.log_evidence());
    const auto is_outdone = [&](const TissueCandidate& one) {
        return std::any_of(
            candidates_.begin(), candidates_.end(), [&](const TissueCandidate& other) {
                return other.law == one.law && other.num_terms < one.num_terms &&
                       has_a_chance(other) && std::isfinite(other.log_evidence()) &&
                       other.log_evidence() > one.log_evidence() - bare_mention + apart_of_terms;
            });
    };
    std::vector<std::size_t> worth;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
        const TissueCandidate& one = candidates_[k];
        if (has_a_chance(one) && !is_finished(one) && !is_outdone(one) &&
            one.log_evidence() > highest - apart_of_laws)
            worth.push_back(k);
    }
    return worth;
}

void ModelFits::find_best() {
    compare_all();
    for (TissueCandidate& one : candidates_)
        if (one.failure) one.search = nullptr;  // the leader, where others began until now
    for (bool has_failed = true; has_failed;) {
        compare_dropped();
        has_failed = false;
        for (auto worth = worth_finding(); !worth.empty() && !has_failed; worth = worth_finding()) {
            run_tasks(worth.size(), jobs_, shared_, [&](std::size_t n) {
                TissueCandidate& one = candidates_[worth[n]];
                attempt(one, [&](TissueSearch& search) {
                    if (!one.is_found) search.find(worth.size() == 1);
                    search.weigh();
                });
                one.can_tell = true;
                one.tried.progress = ModelProgress::finished;
            });
            for (const std::size_t k : worth) has_failed = has_failed || !candidates_[k].search;
        }
    }
}

/// Intervals, mesh check and warnings.
void ModelFits::judge(TissueCandidate& one) {
    const SerialBlas serial;
    one.search->judge();
    take(one);
    const SearchedTissue searched = one.search->found();
    IdentifiedExperiment& found = *one.tried.found;
    const Eigen::VectorXd model_sd = model_sds(one.tried.experiment->parameters());
    if (!searched.halved.empty())
        check_mesh(searched.halved, found, model_sd);
    else if (searched.is_believed)
        check_mesh(configure_, found, shared_.sink(), model_sd);
    one.tried.warnings = warnings_of(found, travel_mm_);
}

/// Where none of the models that have a chance can be solved, the first of their errors tells why.
void ModelFits::rethrow_failure() const {
    for (const TissueCandidate& one : candidates_)
        if (one.failure) std::rethrow_exception(one.failure);
}

AspirationFit ModelFits::run() {
    const auto begin = std::chrono::steady_clock::now();
    if (candidates_.size() == 1) {
        TissueCandidate& one = candidates_.front();
        const SerialBlas serial;
        approach(0);
        one.search->find(true);
        take(one);
    } else {
        find_best();
    }
    std::vector<TissueCandidate*> left;
    for (TissueCandidate& one : candidates_) {
        if (one.search) {
            left.push_back(&one);
            all_.models.push_back(one.tried);
        } else {
            all_.input.warnings.push_back(
                fmt::format("{} could not be fitted: {}", one.tried.name, one.why_failed));
        }
    }
    if (std::none_of(all_.models.begin(), all_.models.end(), [](const TriedModel& one) {
            return one.found && one.progress == ModelProgress::finished;
        }))
        rethrow_failure();
    const auto best = std::size_t(&all_.best() - all_.models.data());
    judge(*left[best]);
    all_.models[best] = left[best]->tried;
    all_.models[best].found->seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return std::move(all_);
}

}  // namespace

Eigen::VectorXd model_sds(const std::vector<Parameter>& parameters) {
    Eigen::VectorXd sds = Eigen::VectorXd::Zero(Eigen::Index(parameters.size()));
    for (std::size_t k = 0; k < parameters.size(); ++k) {
        if (parameters[k].is_nuisance || parameters[k].transform != Transform::log) continue;
        const std::string& name = parameters[k].name;
        sds[Eigen::Index(k)] =
            name == "gamma" || name == "c2_kpa" ? model_sd_ln_of_stiffening : model_sd_ln;
    }
    return sds;
}

AspirationFit fit_models(const AspirationSettings& settings, const AspirationFitInput& input,
                         const Suction& suction, const fs::path& inside, const OptionValues& values,
                         const ProgressSink& progress) {
    return ModelFits(settings, input, suction, inside, values, progress).run();
}

}  // namespace palpate
