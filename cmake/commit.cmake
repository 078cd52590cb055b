# Writes OUTPUT, a header with the commit of SOURCE, where it has changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#pragma once

namespace clearway::bench {

/// The commit that this program was built from.
inline constexpr const char* kCommit = \"${commit}\";

}  // namespace clearway::bench
")
