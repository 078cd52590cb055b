#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <utility>

#include "core/messages/messages.hpp"
#include "io/files/input_error.hpp"

// Refusals and messages whose text fmt formats of arguments.
namespace clearway {

template <typename... Args>
[[noreturn]] void refuse(const std::string& name, fmt::format_string<const Args&...> what,
                         const Args&... args) {
  refuse(name, fmt::format(what, args...));
}

template <typename... Args>
[[noreturn]] void refuse(const std::string& name, Remedy remedy,
                         fmt::format_string<const Args&...> what, const Args&... args) {
  refuse(name, fmt::format(what, args...), remedy);
}

template <typename... Args>
[[noreturn]] void refuse_byte(const std::string& name, std::uint64_t byte,
                              fmt::format_string<const Args&...> what, const Args&... args) {
  refuse_byte(name, byte, fmt::format(what, args...));
}

template <typename... Args>
[[noreturn]] void refuse_line(const std::string& name, std::uint64_t line,
                              fmt::format_string<const Args&...> what, const Args&... args) {
  refuse_line(name, line, fmt::format(what, args...));
}

template <typename... Args>
Message note(NoteCode code, MessageNumbers numbers, fmt::format_string<const Args&...> text,
             const Args&... args) {
  return note(code, fmt::format(text, args...), std::move(numbers));
}

template <typename... Args>
Message warning(WarningCode code, MessageNumbers numbers, fmt::format_string<const Args&...> text,
                const Args&... args) {
  return warning(code, fmt::format(text, args...), std::move(numbers));
}

}  // namespace clearway
