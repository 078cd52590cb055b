#pragma once

#include <string>
#include <string_view>

namespace clearway {

/// A text, such as a body's name, as a cell of a CSV file (RFC 4180): in quotes where it holds a
/// comma, a quote or a line break. A text that a spreadsheet would run as a formula, because it
/// begins with "=", "+", "-", "@", a tab or a line break, gets an apostrophe in front, which
/// spreadsheets take as "this is text". A text that is a number, such as "-12.5", stays as it is.
std::string csv_cell(std::string_view text);

}  // namespace clearway
