#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "support/catch.hpp"

namespace clearway {

/// Checks that the part of a document between the marks `<!-- NAME, made by the tests -->` and
/// `<!-- end of NAME -->` is `text`. With CLEARWAY_UPDATE_DOCS set in the environment, writes it
/// there instead.
inline void check_generated(const std::string& document, const std::string& name,
                            const std::string& text) {
  std::stringstream read;
  read << std::ifstream(document).rdbuf();
  const std::string old = read.str();
  const std::string begin = "<!-- " + name + ", made by the tests -->\n";
  const std::string end = "<!-- end of " + name + " -->\n";
  INFO(document);
  INFO(name);
  const std::size_t from = old.find(begin), to = old.find(end);
  REQUIRE(from != std::string::npos);
  REQUIRE(to != std::string::npos);
  const std::size_t first = from + begin.size();
  if (old.substr(first, to - first) == text) return;
  if (std::getenv("CLEARWAY_UPDATE_DOCS") == nullptr) {
    FAIL("this part is stale: run the test with CLEARWAY_UPDATE_DOCS=1 to make it again");
  }
  std::ofstream(document) << old.substr(0, first) << text << old.substr(to);
}

}  // namespace clearway
