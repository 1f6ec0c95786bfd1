# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# Everything palpate builds on, looked up in one place.

find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
# Compresses three times as fast as zlib; comes with ITK (through libtiff).
find_path(LIBDEFLATE_INCLUDE_DIR libdeflate.h REQUIRED)
find_library(LIBDEFLATE_LIBRARY deflate REQUIRED)
find_package(NLopt 2.7 REQUIRED)
find_package(BLAS REQUIRED)    # OpenBLAS picks its kernels for the processor at run time
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto)    # SHA-256

find_package(Boost 1.74 REQUIRED)    # headers: distributions of Boost.Math

find_package(ITK REQUIRED COMPONENTS
  ITKCommon ITKTransform ITKIONIFTI ITKIONRRD ITKIOMeta ITKIOPNG ITKIOTIFF ITKIOTransformBase
  ITKIOTransformHDF5 ITKIOTransformInsightLegacy ITKPDEDeformableRegistration ITKSmoothing)
add_library(palpate_itk INTERFACE)
target_include_directories(palpate_itk SYSTEM INTERFACE ${ITK_INCLUDE_DIRS})
target_link_libraries(palpate_itk INTERFACE ${ITK_LIBRARIES})
# One Eigen for both: ITK's own copy and ours cannot be included together.
target_compile_definitions(palpate_itk INTERFACE ITK_USE_SYSTEM_EIGEN)
target_compile_options(palpate_itk INTERFACE
  "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-include ${CMAKE_CURRENT_LIST_DIR}/itk_for_clang.hpp>")
find_package(VTK REQUIRED COMPONENTS CommonCore CommonDataModel FiltersCore IOGeometry
  IOLegacy IOPLY IOXML)

if(PALPATE_WITH_OPENCL)
  find_package(OpenCL REQUIRED)
endif()
if(PALPATE_WITH_MUMPS)
  find_path(MUMPS_INCLUDE_DIR dmumps_c.h REQUIRED)
  find_library(MUMPS_LIBRARY dmumps_seq REQUIRED)    # without MPI
  find_path(SCOTCH_INCLUDE_DIR scotch/scotch.h REQUIRED)
  find_library(SCOTCH_LIBRARY scotch REQUIRED)
  find_library(SCOTCHERR_LIBRARY scotcherr REQUIRED)  # what SCOTCH calls when it must say something
endif()
if(PALPATE_WITH_CHOLMOD)
  find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
  find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
endif()
if(PALPATE_WITH_KOKKOS)
  include(PalpateKokkos)
endif()
if(PALPATE_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
if(PALPATE_BUILD_BENCH)
  find_package(benchmark REQUIRED)
endif()

# With relative paths every checkout finds what any other has compiled; the sloppiness is what ccache
# asks for with precompiled headers, whose bytes it hashes all the same.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(ccache_launcher env "CCACHE_BASEDIR=${CMAKE_SOURCE_DIR}"
    "CCACHE_SLOPPINESS=pch_defines,time_macros" "${CCACHE_PROGRAM}")
  set(CMAKE_CXX_COMPILER_LAUNCHER ${ccache_launcher})
  set(CMAKE_C_COMPILER_LAUNCHER ${ccache_launcher})
endif()
