// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

/// In front of a hot, plain loop: compiled for several x86-64 levels, chosen when the program
/// starts, so that a build for any machine uses the vector units of this one. Nothing elsewhere.
/// Levels name features; `arch=haswell` would be chosen on that very processor only.
/// PALPATE_FLATTEN: beside it where the loop calls small functions, which then become part of each
/// version. PALPATE_REGISTER_BYTES: the vectors that such a loop can count on.
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 12 && defined(__x86_64__) && \
    defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PALPATE_MULTIVERSION \
    __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define PALPATE_FLATTEN __attribute__((flatten))
#define PALPATE_REGISTER_BYTES 32
#else
#define PALPATE_MULTIVERSION
#define PALPATE_FLATTEN
#define PALPATE_REGISTER_BYTES 16
#endif
