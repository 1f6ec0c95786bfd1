// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/application.hpp"

#include "host/apps/all.hpp"
#include "host/apps/describe.hpp"
#include "host/faces/capi/guard.hpp"
#include "host/faces/capi/handles.hpp"
#include "host/page/tree_json.hpp"
#include "solver/base/large_blocks.hpp"

using namespace palpate;
using capi::guarded;
using capi::require;

/// The handle.
struct palpate_outcome {
    std::string json;
};

namespace {

/// What it throws names options as settings do.
Outcome run_from_settings(const Application& application, const OptionValues& values,
                          const ProgressSink& progress) {
    try {
        return run_application(application, values, LimitEnds::work, progress);
    } catch (const Error& error) {
        throw Error(error.code(), as_settings_spell(all_options(application), error.what()));
    }
}

}  // namespace

const char* palpate_applications(void) {
    static const std::string text = applications_json(applications());
    return text.c_str();
}

palpate_status palpate_run(const char* application, const char* settings_toml,
                           palpate_progress progress, void* progress_user,
                           palpate_outcome** outcome) {
    return guarded([&] {
        require(outcome, "the place for the outcome");
        *outcome = nullptr;
        require(application, "the name of the application");
        require(settings_toml, "the text of the settings");
        keep_large_blocks();
        const Application& chosen = application_named(application);
        const auto values =
            OptionValues::from_settings(all_options(chosen), settings_toml, "settings");
        const Outcome found =
            run_from_settings(chosen, values, capi::progress_sink(progress, progress_user));
        auto made = std::make_unique<palpate_outcome>();
        made->json = tree_json(found.result);
        *outcome = capi::Handles<palpate_outcome>::all().keep(std::move(made));
        if (found.exit_code == exit_code_not_converged)
            capi::last_error() =
                "a search did not converge, or a case failed; the result says which";
        else if (found.exit_code != 0)
            capi::last_error() = "not every case came to an end; the result says which";
        return static_cast<palpate_status>(found.exit_code);
    });
}

const char* palpate_outcome_json(const palpate_outcome* outcome) {
    const auto body = capi::found(outcome);
    return body ? body->json.c_str() : "";
}

palpate_status palpate_outcome_free(palpate_outcome* outcome) {
    return guarded([&] {
        capi::release(outcome, "the outcome");
        return PALPATE_OK;
    });
}
