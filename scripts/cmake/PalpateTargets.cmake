# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0

# What every target of palpate is compiled with; ours only, never the libraries'.
add_library(palpate_options INTERFACE)
target_include_directories(palpate_options INTERFACE "${CMAKE_SOURCE_DIR}")
target_compile_options(palpate_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor)
if(PALPATE_SANITIZE)
  target_compile_options(palpate_options INTERFACE -fsanitize=${PALPATE_SANITIZE}
                                                   -fno-omit-frame-pointer)
  target_link_options(palpate_options INTERFACE -fsanitize=${PALPATE_SANITIZE})
  if(PALPATE_SANITIZE MATCHES "address")
    target_compile_definitions(palpate_options INTERFACE PALPATE_ADDRESS_SANITIZER)
  endif()
endif()
# Eigen's dense algebra runs on BLAS everywhere: one definition of its templates in the whole program.
target_compile_definitions(palpate_options INTERFACE EIGEN_USE_BLAS)
target_link_libraries(palpate_options INTERFACE
  Eigen3::Eigen Threads::Threads BLAS::BLAS fmt::fmt)
# Layers go into libpalpate.so, too; programs are compiled alike to share precompiled headers.
target_compile_options(palpate_options INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:-fPIC>")
include(PalpateQuickBuild)

# palpate_layer(<name> [ONE_BY_ONE|PLAIN] [SOURCES a.cpp ...] [LINKS target ...]): one folder, one
# target named palpate_<name>. Without sources it is header only. Links are the layers it may include.
# Sources are compiled as palpate_quick_build says; PLAIN: without precompiled headers, too.
function(palpate_layer name)
  cmake_parse_arguments(LAYER "ONE_BY_ONE;PLAIN" "" "SOURCES;LINKS" ${ARGN})
  if(LAYER_SOURCES)
    add_library(palpate_${name} STATIC ${LAYER_SOURCES})
    target_link_libraries(palpate_${name} PUBLIC palpate_options ${LAYER_LINKS})
    if(LAYER_ONE_BY_ONE)
      palpate_quick_build(palpate_${name} palpate_precompiled ONE_BY_ONE)
    elseif(NOT LAYER_PLAIN)
      palpate_quick_build(palpate_${name} palpate_precompiled)
    endif()
  else()
    add_library(palpate_${name} INTERFACE)
    target_link_libraries(palpate_${name} INTERFACE palpate_options ${LAYER_LINKS})
  endif()
endfunction()

# palpate_test(<name> SOURCES a_test.cpp ... [LINKS target ...] [LABELS l ...] [TIMEOUT s]): one
# GoogleTest program, registered with ctest case by case.
function(palpate_test name)
  cmake_parse_arguments(TEST "" "TIMEOUT" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${name} ${TEST_SOURCES})
  target_link_libraries(${name} PRIVATE palpate_test_fixtures ${TEST_LINKS} GTest::gtest_main)
  palpate_quick_build(${name} palpate_precompiled_tests ONE_BY_ONE)
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 300)
  endif()
  if(NOT TEST_LABELS)
    set(TEST_LABELS unit)
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST
    WORKING_DIRECTORY "${CMAKE_SOURCE_DIR}"
    PROPERTIES LABELS "${TEST_LABELS}" TIMEOUT ${TEST_TIMEOUT}
               ENVIRONMENT "PALPATE_DATA=${PALPATE_DATA};OPENBLAS_NUM_THREADS=2")
endfunction()
