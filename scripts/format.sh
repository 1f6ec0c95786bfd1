#!/usr/bin/env bash
# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# Formats every C++ and OpenCL file in place, or with --check fails if one is not formatted.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(-i)
[ "${1:-}" != --check ] || mode=(--dry-run -Werror)
git ls-files '*.cpp' '*.hpp' '*.h' '*.cl' | xargs clang-format "${mode[@]}"
