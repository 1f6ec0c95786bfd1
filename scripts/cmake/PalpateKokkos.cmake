# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# Defines palpate::kokkos, whatever Kokkos there is: an installed one (-DKokkos_ROOT=... points to an
# OpenMP, CUDA or HIP build), else the serial one of Debian's libtrilinos-kokkos-dev. Debian's own
# Kokkos package file names include folders that do not exist, so every candidate is checked first.
add_library(palpate_kokkos_library INTERFACE)
add_library(palpate::kokkos ALIAS palpate_kokkos_library)

find_package(Kokkos QUIET)
set(kokkos_is_usable OFF)
if(TARGET Kokkos::kokkos)
  set(kokkos_is_usable ON)
  foreach(kokkos_target Kokkos::kokkos Kokkos::kokkoscore)
    if(TARGET ${kokkos_target})
      get_target_property(folders ${kokkos_target} INTERFACE_INCLUDE_DIRECTORIES)
      foreach(folder IN LISTS folders)
        if(NOT folder MATCHES "\\$<" AND NOT IS_DIRECTORY "${folder}")
          set(kokkos_is_usable OFF)
        endif()
      endforeach()
    endif()
  endforeach()
endif()

if(kokkos_is_usable)
  target_link_libraries(palpate_kokkos_library INTERFACE Kokkos::kokkos)
  message(STATUS "Kokkos ${Kokkos_VERSION} (${Kokkos_DEVICES}) at '${Kokkos_DIR}'")
else()
  find_path(PALPATE_KOKKOS_INCLUDE_DIR Kokkos_Core.hpp PATH_SUFFIXES trilinos)
  find_library(PALPATE_KOKKOS_CORE NAMES trilinos_kokkoscore kokkoscore)
  if(NOT PALPATE_KOKKOS_INCLUDE_DIR OR NOT PALPATE_KOKKOS_CORE)
    message(FATAL_ERROR "PALPATE_WITH_KOKKOS is ON but no usable Kokkos was found: point "
                        "-DKokkos_ROOT=... to one, install libtrilinos-kokkos-dev, or switch it OFF.")
  endif()
  target_include_directories(palpate_kokkos_library SYSTEM INTERFACE
    "${PALPATE_KOKKOS_INCLUDE_DIR}")
  target_link_libraries(palpate_kokkos_library INTERFACE "${PALPATE_KOKKOS_CORE}" ${CMAKE_DL_LIBS})
  message(STATUS "Kokkos by header and library: '${PALPATE_KOKKOS_CORE}'")
endif()
