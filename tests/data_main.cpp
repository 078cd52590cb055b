// The main function of the test programs that need real data. Without CLEARWAY_TEST_DATA a test is
// skipped, and says so.
#include <cstdlib>

#include "catch_session.hpp"

namespace {

const char* missing_data() {
  if (std::getenv("CLEARWAY_TEST_DATA") != nullptr) return nullptr;
  return "needs real scans; set CLEARWAY_TEST_DATA to their folder";
}

}  // namespace

int main(int argc, char** argv) { return run_catch(argc, argv, missing_data); }
