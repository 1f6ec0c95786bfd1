# SPDX-FileCopyrightText: The palpate developers
# SPDX-License-Identifier: Apache-2.0

# palpate_embed_text(<target> <file> <function>): compiles a text file into <target> as bytes that
# `std::string_view palpate::<function>()` returns. Byte arrays, because compilers limit literals.
# The same file is the script that writes the source when it is run with `cmake -P`.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ "${INPUT}" bytes HEX)
  string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  file(WRITE "${OUTPUT}" "// Made from a text file by EmbedText.cmake.
#include <string_view>
namespace palpate {
std::string_view ${FUNCTION}();
std::string_view ${FUNCTION}() {
    static const unsigned char bytes[] = {
${bytes}
    };
    return {reinterpret_cast<const char*>(bytes), sizeof bytes};
}
}  // namespace palpate
")
  return()
endif()

set(PALPATE_EMBED_TEXT_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

function(palpate_embed_text target file function)
  set(input "${CMAKE_CURRENT_SOURCE_DIR}/${file}")
  set(output "${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp")
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${CMAKE_COMMAND}" "-DINPUT=${input}" "-DOUTPUT=${output}" "-DFUNCTION=${function}"
            -P "${PALPATE_EMBED_TEXT_SCRIPT}"
    DEPENDS "${input}" "${PALPATE_EMBED_TEXT_SCRIPT}"
    COMMENT "Embedding ${file}"
    VERBATIM)
  target_sources(${target} PRIVATE "${output}")
endfunction()
