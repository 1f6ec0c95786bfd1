// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/python/call.hpp"

namespace palpate_python {

void check(palpate_status status) {
    if (status != PALPATE_OK && status != PALPATE_NOT_CONVERGED)
        throw PalpateError(status, palpate_last_error());
}

void require_shape(bool is_right, const char* what) {
    if (!is_right) throw PalpateError(PALPATE_INVALID_ARGUMENT, what);
}

namespace {

/// The error that Python has set, cleared there.
nb::object fetched_error() {
    PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
    PyErr_Fetch(&type, &value, &trace);
    PyErr_NormalizeException(&type, &value, &trace);
    Py_XDECREF(type);
    Py_XDECREF(trace);
    return nb::steal(value);
}

}  // namespace

Progress::Progress(nb::object function) : function_(std::move(function)), raised_(nb::none()) {}

int Progress::call(void* self, const char* stage, double fraction, const char* message) {
    auto& progress = *static_cast<Progress*>(self);
    nb::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) {
        progress.raised_ = fetched_error();
        return 1;
    }
    if (progress.function_.is_none()) return 0;
    try {
        const nb::object answer = progress.function_(stage, fraction, message);
        return answer.is_none() ? 0 : !nb::cast<bool>(answer);
    } catch (nb::python_error& error) {
        progress.raised_ = nb::borrow(error.value());
    } catch (const nb::cast_error&) {
        PyErr_SetString(PyExc_TypeError, "progress must return True, False or None");
        progress.raised_ = fetched_error();
    }
    return 1;
}

void Progress::raise_again() {
    if (raised_.is_none()) return;
    const nb::object value = std::move(raised_);
    raised_ = nb::none();
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(value.ptr())), value.ptr());
    throw nb::python_error();
}

void add_errors(nb::module_& module) {
    static nb::exception<PalpateError> error_type(module, "PalpateError", PyExc_RuntimeError);
    nb::register_exception_translator([](const std::exception_ptr& pointer, void*) {
        try {
            std::rethrow_exception(pointer);
        } catch (const PalpateError& error) {
            nb::object value = nb::borrow(error_type)(error.what());
            nb::setattr(value, "status", nb::int_(static_cast<int>(error.status)));
            PyErr_SetObject(error_type.ptr(), value.ptr());
        }
    });
}

}  // namespace palpate_python
