// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

// Each adds one level of palpate.h to the module.
namespace palpate_python {

namespace nb = nanobind;

void add_solver(nb::module_& module);
void add_recovery(nb::module_& module);
void add_phantom(nb::module_& module);
void add_application(nb::module_& module);
void add_tracker(nb::module_& module);

}  // namespace palpate_python
