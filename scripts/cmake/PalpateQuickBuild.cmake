# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# What makes a build from nothing three times as quick: the libraries' headers are compiled once, not
# for each source, and sources of one folder are compiled together. Both hide a forgotten #include, so
# `dev` and the sanitizers build without them; two sources of a folder may not name things alike in
# their unnamed name spaces.
option(PALPATE_QUICK_BUILD "Compile headers once, and several sources of a folder together" ON)
set(palpate_sources_together 12)    # of 2 GB compilers, and enough of them for several cores
set(PALPATE_PRECOMPILED_SOURCE "${CMAKE_CURRENT_LIST_DIR}/precompiled.cpp")

# palpate_precompile(<target> [LINKS target ...] HEADERS <h> ...): an object library that holds
# compiled headers. All that use them have to be compiled alike, which is why programs are position
# independent, too.
function(palpate_precompile target)
  cmake_parse_arguments(PRECOMPILE "" "" "LINKS;HEADERS" ${ARGN})
  if(NOT PALPATE_QUICK_BUILD)
    return()
  endif()
  add_library(${target} OBJECT "${PALPATE_PRECOMPILED_SOURCE}")
  target_link_libraries(${target} PRIVATE palpate_options ${PRECOMPILE_LINKS})
  target_precompile_headers(${target} PRIVATE ${PRECOMPILE_HEADERS})
endfunction()

# palpate_quick_build(<target> <precompiled> [ONE_BY_ONE]): ONE_BY_ONE where sources of a folder use the
# same words, each for itself, as tests do.
function(palpate_quick_build target precompiled)
  if(NOT PALPATE_QUICK_BUILD)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${precompiled})
  if(NOT "ONE_BY_ONE" IN_LIST ARGN)
    set_target_properties(${target} PROPERTIES
      UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${palpate_sources_together})
  endif()
endfunction()

# GCC 12 forgets which precompiled headers are a system's, and tells of bounds inside std::string.
if(PALPATE_QUICK_BUILD)
  string(JOIN ";" precompiling_options -fpch-preprocess -Winvalid-pch
    -Wno-array-bounds -Wno-restrict -Wno-stringop-overread)
  target_compile_options(palpate_options INTERFACE
    "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:${precompiling_options}>")
endif()

set(palpate_common_headers
  <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map>
  <memory> <mutex> <numbers> <optional> <set> <span> <sstream> <string> <string_view> <thread>
  <utility> <vector>
  <Eigen/Dense> <Eigen/SparseCore> <fmt/format.h>)
palpate_precompile(palpate_precompiled HEADERS ${palpate_common_headers})
if(PALPATE_BUILD_TESTS)
  palpate_precompile(palpate_precompiled_tests
    LINKS GTest::gtest HEADERS ${palpate_common_headers} <gtest/gtest.h>)
endif()
