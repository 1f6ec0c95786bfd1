// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nanobind/nanobind.h>

#include <stdexcept>
#include <string>

#include "host/faces/capi/palpate.h"

// Calls into palpate: statuses become exceptions, Python is free meanwhile, and it is asked now and
// then whether to go on.
namespace palpate_python {

namespace nb = nanobind;

struct PalpateError : std::runtime_error {
    PalpateError(palpate_status code, const std::string& text)
        : std::runtime_error(text), status(code) {}
    palpate_status status;
};

/// Throws PalpateError with palpate's sentence, unless the call succeeded or did not converge.
void check(palpate_status status);

/// Throws PalpateError(PALPATE_INVALID_ARGUMENT) with `what`.
void require_shape(bool is_right, const char* what);

/// Calls a Python function (stage, fraction, message) -> truth of "go on"; None goes on too. What
/// it raises, or a signal such as Ctrl-C raises, cancels, and is raised again where palpate was
/// called.
class Progress {
public:
    explicit Progress(nb::object function);
    /// For Python's collector of cycles: the function may hold who holds this.
    nb::object& function() { return function_; }
    /// A palpate_progress; `self` is a Progress.
    static int call(void* self, const char* stage, double fraction, const char* message);
    /// Runs `work`, which returns a status, without the interpreter's lock.
    template <class Work>
    palpate_status run(Work&& work) {
        palpate_status status = PALPATE_OK;
        {
            nb::gil_scoped_release free;
            status = work();
        }
        raise_again();
        check(status);
        return status;
    }

private:
    void raise_again();
    nb::object function_;
    nb::object raised_;
};

/// Adds the exception to the module and translates ours into it.
void add_errors(nb::module_& module);

}  // namespace palpate_python
