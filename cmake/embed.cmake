# clearway_embed(SOURCE HEADER NAMESPACE NAME=FILE|FILE...) makes a source of the text kNAME, which
# HEADER declares within NAMESPACE of clearway: the bytes of its files, in this order.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  function(clearway_embed source header namespace)
    string(REGEX REPLACE "(^|;)[A-Za-z]+=" "\\1" files "${ARGN}")
    string(REPLACE "|" ";" files "${files}")
    string(REPLACE ";" "||" parts "${ARGN}")
    add_custom_command(OUTPUT ${source}
      COMMAND ${CMAKE_COMMAND} -DHEADER=${header} -DNAMESPACE=${namespace} "-DPARTS=${parts}"
        -DOUTPUT=${source} -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
      DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
      VERBATIM)
    set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endfunction()
  return()
endif()

set(text "#include \"${HEADER}\"

namespace clearway {
")
string(REPLACE "||" ";" PARTS "${PARTS}")
foreach(part ${PARTS})
  string(REGEX MATCH "^([^=]+)=(.*)$" part "${part}")
  set(name ${CMAKE_MATCH_1})
  string(REPLACE "|" ";" files "${CMAKE_MATCH_2}")
  set(bytes "")
  foreach(file ${files})
    file(READ ${file} hex HEX)
    string(APPEND bytes "${hex}")
  endforeach()
  string(LENGTH "${bytes}" length)
  math(EXPR count "${length} / 2")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  set(byte "0x..,")
  string(REGEX REPLACE "(${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte}${byte})"
    "\\1\n" bytes "${bytes}")
  string(APPEND text "
const unsigned char k${name}Bytes[] = {\n${bytes}0};
const std::string_view ${NAMESPACE}::k${name}{reinterpret_cast<const char*>(k${name}Bytes), ${count}};
")
endforeach()
file(WRITE ${OUTPUT} "${text}
}  // namespace clearway
")
