#pragma once

#include <string>
#include <string_view>

namespace clearway {

/// The text escaped for an element or an attribute of HTML or XML. Bytes that are not UTF-8 become
/// U+FFFD, and control characters, which XML cannot hold, become blanks.
std::string markup_text(std::string_view text);

}  // namespace clearway
