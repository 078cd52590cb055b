# Writes OUTPUT, a source that holds the page's files: the HTML, and the styles and scripts put
# together in the order given. HTML, SECTION_HTML; STYLES, SCRIPTS, SECTION_SCRIPTS: lists joined
# by "|".
function(embed name files)
  set(bytes "")
  string(REPLACE "|" ";" files "${files}")
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
  set(text "${text}
const unsigned char k${name}Bytes[] = {\n${bytes}0};
const std::string_view page_parts::k${name}{reinterpret_cast<const char*>(k${name}Bytes), ${count}};
" PARENT_SCOPE)
endfunction()

set(text "#include \"report/page.hpp\"

namespace clearway {
")
embed(Html "${HTML}")
embed(Style "${STYLES}")
embed(Script "${SCRIPTS}")
embed(SectionHtml "${SECTION_HTML}")
embed(SectionScript "${SECTION_SCRIPTS}")
file(WRITE ${OUTPUT} "${text}
}  // namespace clearway
")
