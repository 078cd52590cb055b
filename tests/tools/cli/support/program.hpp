#pragma once

#include <filesystem>
#include <string>

#include "support/result_fixture.hpp"

namespace clearway::test {

struct Outcome {
  int exit_code;
  std::string out, err;
};

/// Runs a program with `arguments` (shell words); its output goes into files of `folder`. pipe: if
/// given, a file whose bytes come through a pipe to standard input.
Outcome run_program_at(const std::string& program, const ScratchFolder& folder,
                       const std::string& arguments, const std::filesystem::path& pipe = {});

/// Runs the built program clearway as run_program_at does.
Outcome run_program(const ScratchFolder& folder, const std::string& arguments,
                    const std::filesystem::path& pipe = {});

std::string quoted(const std::filesystem::path& path);

}  // namespace clearway::test
