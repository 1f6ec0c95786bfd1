# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0
# Puts device program text into the library as byte arrays (long string literals break some
# compilers). Included by a CMakeLists.txt it defines palpate_embed_kernels; run as a script
# (cmake -DINPUT=a.cl -DOUTPUT=a.cpp -DSYMBOL=a -P embed_kernels.cmake) it writes one array.

if(CMAKE_SCRIPT_MODE_FILE)
  file(READ "${INPUT}" bytes HEX)
  string(LENGTH "${bytes}" digits)
  math(EXPR count "${digits} / 2")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(REGEX REPLACE "((0x..,){20})" "\\1\n" bytes "${bytes}")
  file(WRITE "${OUTPUT}"
    "// Made from ${SYMBOL} by embed_kernels.cmake.\n"
    "namespace palpate::embedded {\n"
    "extern const unsigned char ${SYMBOL}[];\n"
    "extern const unsigned long ${SYMBOL}_size;\n"
    "const unsigned char ${SYMBOL}[] = {\n${bytes}0};\n"
    "const unsigned long ${SYMBOL}_size = ${count};\n"
    "}  // namespace palpate::embedded\n")
  return()
endif()

# palpate_embed_kernels(<variable> <folder> <file>...): one build rule per listed file; sets
# <variable> to the sources to compile, among them the table behind `kernel_text(name)`.
function(palpate_embed_kernels variable folder)
  set(output_folder "${CMAKE_CURRENT_BINARY_DIR}/embedded")
  set(script "${CMAKE_SOURCE_DIR}/scripts/cmake/embed_kernels.cmake")
  set(sources "")
  set(declarations "")
  set(rows "")
  foreach(file IN LISTS ARGN)
    string(MAKE_C_IDENTIFIER "${file}" symbol)
    set(output "${output_folder}/${symbol}.cpp")
    add_custom_command(OUTPUT "${output}"
      COMMAND "${CMAKE_COMMAND}" "-DINPUT=${folder}/${file}" "-DOUTPUT=${output}"
              "-DSYMBOL=${symbol}" -P "${script}"
      DEPENDS "${folder}/${file}" "${script}" VERBATIM)
    list(APPEND sources "${output}")
    string(APPEND declarations "extern const unsigned char ${symbol}[];\n"
                               "extern const unsigned long ${symbol}_size;\n")
    string(APPEND rows "    {\"${file}\", embedded::${symbol}, embedded::${symbol}_size},\n")
  endforeach()
  file(CONFIGURE OUTPUT "${output_folder}/kernel_table.cpp" CONTENT
"// Made by embed_kernels.cmake.
#include \"solver/backends/opencl/kernel_text.hpp\"

namespace palpate {
namespace embedded {
${declarations}}  // namespace embedded

const std::vector<EmbeddedFile>& embedded_kernels() {
    static const std::vector<EmbeddedFile> table = {
${rows}    };
    return table;
}

}  // namespace palpate
" @ONLY)
  set(${variable} "${sources};${output_folder}/kernel_table.cpp" PARENT_SCOPE)
endfunction()
