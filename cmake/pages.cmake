# Writes OUTPUT, a source that holds the pages. FRAME is their common HTML, into which the parts of a
# page go, its styles and its scripts. CROSS_SECTION and what ends in PARTS are HTML; STYLES and what
# ends in SCRIPTS are lists joined by "|", whose files are put together in this order.
# What stays in double braces is put in where a page is written.
function(read_files variable files)
  string(REPLACE "|" ";" files "${files}")
  foreach(file ${files})
    file(READ ${file} content)
    string(APPEND text "${content}")
  endforeach()
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

function(embed name answer parts scripts) # further styles
  read_files(page "${FRAME}")
  read_files(parts "${parts}")
  read_files(route "${CROSS_SECTION}")
  read_files(style "${STYLES}|${ARGN}")
  read_files(script "${scripts}")
  foreach(place answer parts route style script)
    string(TOUPPER "{{${place}}}" there)
    string(REPLACE "${there}" "${${place}}" page "${page}")
  endforeach()
  string(APPEND source "\nconst std::string_view k${name} = R\"page(${page})page\";\n")
  set(source "${source}" PARENT_SCOPE)
endfunction()

set(source "#include \"report/page.hpp\"

namespace clearway {
")
embed(ReportPage Verdict "${REPORT_PARTS}" "${SCRIPTS}")
embed(SectionPage Answer "${SECTION_PARTS}" "${SECTION_SCRIPTS}")
embed(ComparisonPage Answer "${COMPARISON_PARTS}" "${COMPARISON_SCRIPTS}")
embed(CampaignPage Answer "" "${CAMPAIGN_SCRIPTS}" "${CAMPAIGN_STYLE}")
file(WRITE ${OUTPUT} "${source}
}  // namespace clearway
")
