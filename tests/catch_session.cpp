// The only file in which Catch is compiled.
#define CATCH_CONFIG_RUNNER
#include "catch_session.hpp"

#include <iostream>

#include "support/catch.hpp"

int run_catch(int argc, char** argv, const char* (*missing)()) {
  Catch::Session session;
  if (const int error = session.applyCommandLine(argc, argv)) return error;
  const auto& config = session.configData();
  bool lists = config.listTests || config.listTags || config.listReporters;
#if CATCH_VERSION_MAJOR == 2
  lists = lists || config.listTestNamesOnly;
#endif
  const char* reason = lists || missing == nullptr ? nullptr : missing();
  if (reason != nullptr) {
    std::cout << "skipped: " << reason << '\n';
    return 77;
  }
  return session.run() == 0 ? 0 : 1;  // the number of failures could be 77
}
