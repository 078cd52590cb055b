#pragma once

#include <cstdlib>
#include <filesystem>

namespace clearway::test {

/// The folder of real scans, for programs made with clearway_add_data_tests only.
inline std::filesystem::path data_folder() { return std::getenv("CLEARWAY_TEST_DATA"); }

}  // namespace clearway::test
