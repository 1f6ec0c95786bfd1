// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "host/faces/capi/palpate.h"

namespace palpate_python {

/// Who solves, and how well: palpate_solver_options with strings of its own.
struct SolverChoice {
    std::string method = "auto", backend, device;
    bool use_double = false;
    double relative_tolerance = 1e-8;
    std::int32_t expected_columns = 1;

    palpate_solver_options options() const {
        palpate_solver_options options;
        palpate_solver_options_init(&options);
        options.method = method.c_str();
        if (!backend.empty()) options.backend = backend.c_str();
        if (!device.empty()) options.device = device.c_str();
        options.use_double = use_double;
        options.relative_tolerance = relative_tolerance;
        options.expected_columns = expected_columns;
        return options;
    }
};

}  // namespace palpate_python
