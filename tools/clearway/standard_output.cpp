#include "clearway/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/error.hpp"

namespace clearway::tool {

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw ResourceError(std::string("standard output: cannot write: ") + std::strerror(errno));
  }
}

}  // namespace clearway::tool
