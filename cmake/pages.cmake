# Writes OUTPUT, a source that holds the pages. Each is the frame page.html of the folder PAGE, into
# which the parts of the page go, its styles and its scripts, files of that folder in this order.
# What stays in double braces is put in where a page is written.
function(read_files variable ending)
  foreach(name ${ARGN})
    file(READ ${PAGE}/${name}.${ending} content)
    string(APPEND text "${content}")
  endforeach()
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

function(embed name answer parts styles scripts)
  read_files(page html page)
  read_files(parts html ${parts})
  read_files(route html cross_section)
  read_files(style css style print ${styles})
  read_files(script js ${scripts})
  foreach(place answer parts route style script)
    string(TOUPPER "{{${place}}}" there)
    string(REPLACE "${there}" "${${place}}" page "${page}")
  endforeach()
  string(APPEND source "\nconst std::string_view k${name} = R\"page(${page})page\";\n")
  set(source "${source}" PARENT_SCOPE)
endfunction()

set(source "#include \"report/page_parts.hpp\"

namespace clearway {
")
embed(ReportPage Verdict report_parts ""
  "begin;columns;geometry;words;kit;painter;pictures;labels;symbols;chart;unsearched;unseen;front;\
on_site;ledger;verdict;profile;pointer;plan;shifts;table;stations;section;section_map;details;webgl;\
view;view_controls;print;main")
embed(SectionPage Answer section_parts ""
  "begin;columns;geometry;words;kit;symbols;chart;section;section_map;section_stops;section_page")
embed(ComparisonPage Answer comparison_parts "" "begin;words;kit;labels;symbols;comparison")
embed(CampaignPage Answer "" campaign "begin;words;kit;campaign")
file(WRITE ${OUTPUT} "${source}
}  // namespace clearway
")
