#pragma once

#include <string>
#include <vector>

#include "io/paths/remarks.hpp"

namespace clearway {

/// What a table describes, and so which of its columns would change where a vehicle is.
enum class PathTable {
  kPoses,       ///< poses, which have all rotations and heights
  kLine,        ///< places without a height
  kRaisedLine,  ///< places with a height
};

/// Remarks on the columns of a table that are not read: a warning where the name of one says that
/// it holds a cant, or for a line a roll or the height that it lacks; otherwise a note. names: in
/// lower case. file: for the message.
void remark_unread_columns(const std::string& file, const std::vector<std::string>& names,
                           PathTable table, Remarks& out);

}  // namespace clearway
