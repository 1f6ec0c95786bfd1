// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
// Python's view of palpate.h: arrays in and out, no logic. The package's Python files name things.
#include "host/faces/python/module.hpp"

#include <nanobind/stl/string.h>

#include "host/faces/python/call.hpp"

NB_MODULE(_core, m) {
    m.doc() = "The C interface of palpate on NumPy arrays.";
    m.def("version", [] { return std::string(palpate_version()); });
    palpate_python::add_errors(m);
    palpate_python::add_solver(m);
    palpate_python::add_recovery(m);
    palpate_python::add_phantom(m);
    palpate_python::add_application(m);
    palpate_python::add_tracker(m);
}
