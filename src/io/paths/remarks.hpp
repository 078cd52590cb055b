#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {

/// Notes and warnings on a file that was read.
struct Remarks {
  std::vector<Message> remarks;

  void note(NoteCode code, std::string text, MessageNumbers numbers = {}) {
    remarks.push_back(clearway::note(code, std::move(text), std::move(numbers)));
  }
  void warn(WarningCode code, std::string text, MessageNumbers numbers = {}) {
    remarks.push_back(warning(code, std::move(text), std::move(numbers)));
  }
  template <typename... Args>
  void note(NoteCode code, MessageNumbers numbers, fmt::format_string<const Args&...> text,
            const Args&... args) {
    note(code, fmt::format(text, args...), std::move(numbers));
  }
  template <typename... Args>
  void warn(WarningCode code, MessageNumbers numbers, fmt::format_string<const Args&...> text,
            const Args&... args) {
    warn(code, fmt::format(text, args...), std::move(numbers));
  }
  void warn_or_note(bool warns, EitherCode code, std::string text, MessageNumbers numbers = {}) {
    remarks.push_back(warning_or_note(warns, code, std::move(text), std::move(numbers)));
  }
};

/// Names for a message, in quotes, of which a file may have thousands.
inline std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    list += (i == 0 ? "" : ", ") + excerpt(names[i]);
  }
  return names.size() > kMost ? list + " and " + format_count(names.size() - kMost) + " more"
                              : list;
}

}  // namespace clearway
