// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <utility>

#include "host/faces/python/call.hpp"
#include "host/faces/python/module.hpp"

namespace palpate_python {

using namespace nb::literals;

namespace {

struct Free {
    void operator()(palpate_outcome* outcome) const { palpate_outcome_free(outcome); }
};

/// (status, result as JSON). A status that comes with a result is no exception.
std::pair<int, std::string> run(const std::string& application, const std::string& settings,
                                nb::object function) {
    Progress progress(std::move(function));
    std::unique_ptr<palpate_outcome, Free> outcome;
    palpate_status status = PALPATE_OK;
    progress.run([&] {
        palpate_outcome* made = nullptr;
        status =
            palpate_run(application.c_str(), settings.c_str(), Progress::call, &progress, &made);
        outcome.reset(made);
        return made ? PALPATE_OK : status;
    });
    return {static_cast<int>(status), palpate_outcome_json(outcome.get())};
}

}  // namespace

void add_application(nb::module_& m) {
    m.def("applications", [] { return std::string(palpate_applications()); });
    m.def("run", &run, "application"_a, "settings"_a, "progress"_a.none());
}

}  // namespace palpate_python
