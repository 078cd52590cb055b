# Writes OUTPUT, a source that holds the pages' files. FRAME, REPORT_PARTS, SECTION_PARTS and
# CROSS_SECTION are HTML; STYLES, SCRIPTS and SECTION_SCRIPTS are lists joined by "|", whose files
# are put together in this order.
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
embed(Frame "${FRAME}")
embed(ReportParts "${REPORT_PARTS}")
embed(SectionParts "${SECTION_PARTS}")
embed(CrossSection "${CROSS_SECTION}")
embed(Style "${STYLES}")
embed(Script "${SCRIPTS}")
embed(SectionScript "${SECTION_SCRIPTS}")
file(WRITE ${OUTPUT} "${text}
}  // namespace clearway
")
