#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "support/compare_json.hpp"
#include "support/result_fixture.hpp"

namespace clearway::test {

struct Outcome {
  int exit_code;
  std::string out, err;
  std::string arguments;  ///< what the program was called with
};

/// Runs a program in `folder` with `arguments` (shell words), so that files of the folder need no
/// path; its output goes into files there. pipe: if given, a file whose bytes come through a pipe
/// to standard input.
Outcome run_program_at(const std::string& program, const ScratchFolder& folder,
                       const std::string& arguments, const std::filesystem::path& pipe = {});

/// Runs the built program clearway as run_program_at does.
Outcome run_program(const ScratchFolder& folder, const std::string& arguments,
                    const std::filesystem::path& pipe = {});

std::string quoted(const std::filesystem::path& path);

/// A line of a trajectory: the pose of a model that is not turned.
std::string pose_at(double x, double y = 0, double z = 0);

/// The trajectory of `poses` poses along the x axis, from `from` on.
std::string path_along_x(int poses, double step, double from = 0);

/// Words for check_says() that any text holds.
inline constexpr std::string_view kAnything = " ... ";

/// Checks the exit code of a program, and the words of its messages and of what it printed, as
/// check_says() does. Returns the same outcome.
const Outcome& check_outcome(const Outcome& outcome, int exit_code,
                             std::string_view err = kAnything, std::string_view out = kAnything,
                             const Caller& caller = Caller::current());

/// Checks that a program ended with this exit code and a message, and printed nothing else.
void check_refused(const Outcome& outcome, int exit_code, std::string_view message,
                   const Caller& caller = Caller::current());

/// Ends the test where a program failed.
const Outcome& require_success(const Outcome& outcome, const Caller& caller = Caller::current());

/// The JSON that a program printed; ends the test where it printed something else.
nlohmann::json json_of(const Outcome& outcome, const Caller& caller = Caller::current());

/// The codes of the messages of a report, in their order.
std::vector<std::string> codes_in(const nlohmann::json& messages);

/// A row of a table: a question to a program, and what is expected of its answer. A program that
/// refuses, with exit code 2, 3 or 4, has to print messages alone.
struct Case {
  std::string arguments;
  int exit_code = 0;
  std::string_view err = kAnything, out = kAnything;  ///< words, as for check_says()
  std::string_view json = "";  ///< members of the JSON that is printed, as for check_json()
};

/// Asks the questions one after another. ask: runs a program with the arguments of a case.
void check_cases(const std::function<Outcome(const std::string&)>& ask,
                 const std::vector<Case>& cases, const Caller& caller = Caller::current());

/// A folder for the files of a test, in which the program runs.
class Workplace {
 public:
  Outcome run(const std::string& arguments, const std::filesystem::path& pipe = {}) const;
  /// Runs the program, which has to end with exit code 0.
  Outcome succeed(const std::string& arguments, const Caller& caller = Caller::current()) const;
  /// The JSON that the program prints with exit code 0.
  nlohmann::json answer(const std::string& arguments,
                        const Caller& caller = Caller::current()) const;
  /// Runs a table of questions.
  void check(const std::vector<Case>& cases, const Caller& caller = Caller::current()) const;

  void put(const std::string& name, const std::string& bytes) const;
  std::string bytes(const std::string& name) const { return bytes_of(folder / name); }
  bool has(const std::string& name) const { return std::filesystem::exists(folder / name); }
  std::string path(const std::string& name) const { return quoted(folder / name); }

  ScratchFolder folder = {};
};

}  // namespace clearway::test
