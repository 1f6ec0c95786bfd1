// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/apps/all.hpp"

#include "host/apps/aspirate/aspirate_application.hpp"
#include "host/apps/identify/identify_application.hpp"
#include "host/apps/phantom/phantom_application.hpp"
#include "host/apps/recover/run/recover_application.hpp"
#include "host/apps/simulate/simulate_application.hpp"
#include "host/apps/springs/springs.hpp"
#include "host/apps/study/study_application.hpp"
#include "solver/base/error.hpp"

namespace palpate {

const std::vector<Application>& applications() {
    static const std::vector<Application> all = {
        recover_application(),  phantom_application(), simulate_application(),
        identify_application(), study_application(),   springs_application(),
        aspirate_application(),
    };
    return all;
}

const Application& application_named(const std::string& name) {
    std::string names;
    for (const Application& application : applications()) {
        if (application.name == name) return application;
        names += (names.empty() ? "" : ", ") + application.name;
    }
    throw Error(ErrorCode::invalid_argument,
                "there is no application '" + name + "'; there are " + names);
}

}  // namespace palpate
