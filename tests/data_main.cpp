// Main of the test programs that need real data: without CLEARWAY_TEST_DATA a test is skipped, and
// says so.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
  Catch::Session session;
  if (const int error = session.applyCommandLine(argc, argv)) return error;
  const auto& config = session.configData();
  const bool lists = config.listTests || config.listTestNamesOnly || config.listTags;
  if (!lists && std::getenv("CLEARWAY_TEST_DATA") == nullptr) {
    std::cout << "skipped: needs real scans; set CLEARWAY_TEST_DATA to their folder\n";
    return 77;
  }
  return session.run();
}
