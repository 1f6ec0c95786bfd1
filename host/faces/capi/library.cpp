// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/faces/capi/guard.hpp"
#include "host/system/version.hpp"

const char* palpate_status_text(palpate_status status) {
    switch (status) {
        case PALPATE_OK:
            return "ok";
        case PALPATE_INTERNAL:
            return "internal error";
        case PALPATE_INVALID_ARGUMENT:
            return "invalid argument";
        case PALPATE_INPUT_UNREADABLE:
            return "unreadable input";
        case PALPATE_INPUT_UNUSABLE:
            return "unusable input";
        case PALPATE_MESH_FAILED:
            return "meshing failed";
        case PALPATE_SOLVE_FAILED:
            return "solve failed";
        case PALPATE_NOT_CONVERGED:
            return "not converged";
        case PALPATE_DEVICE_FAILED:
            return "device or memory failed";
        case PALPATE_TIME_LIMIT:
            return "time limit";
        case PALPATE_OUTPUT_FAILED:
            return "output failed";
        case PALPATE_CANCELLED:
            return "cancelled";
    }
    return "unknown status";
}

const char* palpate_last_error(void) { return palpate::capi::last_error().c_str(); }

const char* palpate_version(void) {
    static const std::string text = palpate::version_text();
    return text.c_str();
}

int palpate_abi_version(void) { return 2004; }
