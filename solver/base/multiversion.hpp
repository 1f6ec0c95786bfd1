// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// In front of a hot, plain loop: compiled for several x86-64 levels, chosen when the program
/// starts, so that a build for any machine uses the vector units of this one. Nothing elsewhere.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__gnu_linux__) && \
    !defined(__SANITIZE_ADDRESS__)
#define PALPATE_MULTIVERSION \
    __attribute__((target_clones("arch=skylake-avx512", "arch=haswell", "default")))
#else
#define PALPATE_MULTIVERSION
#endif
