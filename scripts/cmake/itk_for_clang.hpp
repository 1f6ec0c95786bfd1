// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Included before all else where clang compiles what uses ITK. An ITK that GCC has built, as
// Debian's, stops at every other compiler when it looks which features there are. All those of
// C++17 are, so it is shown a GCC for as long as it looks.
#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#undef __clang__
#undef __GNUC__
#define __GNUC__ 12
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
