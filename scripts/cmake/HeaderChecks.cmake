# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# Compiles every header alone once: each must include what it uses.
# palpate_check_headers(<target> LINKS target ...): all headers under solver/ and host/.
function(palpate_check_headers target)
  cmake_parse_arguments(CHECK "" "" "LINKS" ${ARGN})
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${CMAKE_SOURCE_DIR}"
    "${CMAKE_SOURCE_DIR}/solver/*.hpp" "${CMAKE_SOURCE_DIR}/host/*.hpp")
  if(NOT PALPATE_WITH_OPENCL)
    list(FILTER headers EXCLUDE REGEX "^solver/backends/opencl/")
  endif()
  if(NOT PALPATE_WITH_KOKKOS)
    list(FILTER headers EXCLUDE REGEX "^solver/backends/kokkos/")
  endif()
  if(NOT PALPATE_WITH_PYTHON)
    list(FILTER headers EXCLUDE REGEX "^host/python/")
  endif()
  foreach(header IN LISTS headers)
    string(REPLACE "/" "_" stem "${header}")
    set(unit "${CMAKE_CURRENT_BINARY_DIR}/${target}/${stem}.cpp")
    if(NOT EXISTS "${unit}")
      file(WRITE "${unit}" "#include \"${header}\"\n")
    endif()
    list(APPEND units "${unit}")
  endforeach()
  add_library(${target} OBJECT ${units})
  target_link_libraries(${target} PRIVATE palpate_options ${CHECK_LINKS})
  target_compile_options(${target} PRIVATE -O0)    # read, not run
endfunction()
