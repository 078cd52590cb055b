#pragma once

#include <string_view>

/// The files of src/report/page, which the build puts into the program.
namespace clearway::page_parts {

extern const std::string_view kHtml, kStyle, kScript;

}  // namespace clearway::page_parts
