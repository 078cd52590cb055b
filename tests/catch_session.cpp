// The only file in which Catch is compiled.
#define CATCH_CONFIG_RUNNER
#include "catch_session.hpp"

#include <catch2/catch.hpp>
#include <iostream>

int run_catch(int argc, char** argv, const char* (*missing)()) {
  Catch::Session session;
  if (const int error = session.applyCommandLine(argc, argv)) return error;
  const auto& config = session.configData();
  const bool lists = config.listTests || config.listTestNamesOnly || config.listTags;
  const char* reason = lists || missing == nullptr ? nullptr : missing();
  if (reason != nullptr) {
    std::cout << "skipped: " << reason << '\n';
    return 77;
  }
  return session.run();
}
