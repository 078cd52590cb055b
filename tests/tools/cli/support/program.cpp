#include "tools/cli/support/program.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <stdexcept>

#include "support/catch.hpp"

namespace clearway::test {

Outcome run_program_at(const std::string& program, const ScratchFolder& folder,
                       const std::string& arguments, const std::filesystem::path& pipe) {
  const auto out = folder / "stdout.txt", err = folder / "stderr.txt";
  // The file is removed, because one that the shell cuts to nothing goes to the disk when it is
  // closed.
  std::filesystem::remove(out);
  std::filesystem::remove(err);
  const std::string before = pipe.empty() ? "" : "cat '" + pipe.string() + "' | ";
  const std::string command = "cd " + quoted(folder / "") + " && " + before + "'" + program + "' " +
                              arguments + " >'" + out.string() + "' 2>'" + err.string() + "'";
  const int status = std::system(command.c_str());
  if (status == -1 || !WIFEXITED(status)) throw std::runtime_error("did not exit: " + command);
  return {WEXITSTATUS(status), bytes_of(out), bytes_of(err), arguments};
}

Outcome run_program(const ScratchFolder& folder, const std::string& arguments,
                    const std::filesystem::path& pipe) {
  const char* const other = std::getenv("CLEARWAY_PROGRAM");  // tools/bench/same_outputs.py
  return run_program_at(other != nullptr ? other : CLEARWAY_PROGRAM, folder, arguments, pipe);
}

std::string quoted(const std::filesystem::path& path) {
  return std::string("'").append(path.string()).append("'");
}

std::string pose_at(double x, double y, double z) {
  return "1 0 0 " + std::to_string(x) + " 0 1 0 " + std::to_string(y) + " 0 0 1 " +
         std::to_string(z) + "\n";
}

std::string path_along_x(int poses, double step, double from) {
  std::string text;
  for (int i = 0; i < poses; ++i) text += pose_at(from + i * step);
  return text;
}

namespace {

/// Names a program's call and all that it wrote in the message of every check that fails.
class Shown {
 public:
  explicit Shown(const Outcome& outcome, const Caller& caller) : name_(text(outcome), caller) {}

 private:
  static std::string text(const Outcome& outcome) {
    constexpr std::size_t kMost = 3000;
    return outcome.arguments + "\nprinted: " + outcome.out.substr(0, kMost) +
           "\nand as messages: " + outcome.err.substr(0, kMost);
  }

  RowName name_;
};

}  // namespace

const Outcome& check_outcome(const Outcome& outcome, int exit_code, std::string_view err,
                             std::string_view out, const Caller& caller) {
  const Shown shown(outcome, caller);
  check_equal(outcome.exit_code, exit_code, caller);
  check_says(outcome.err, err, caller);
  check_says(outcome.out, out, caller);
  return outcome;
}

void check_refused(const Outcome& outcome, int exit_code, std::string_view message,
                   const Caller& caller) {
  check_outcome(outcome, exit_code, message, "", caller);
}

const Outcome& require_success(const Outcome& outcome, const Caller& caller) {
  const Shown shown(outcome, caller);
  check_equal(outcome.exit_code, 0, caller);
  REQUIRE(outcome.exit_code == 0);
  return outcome;
}

nlohmann::json json_of(const Outcome& outcome, const Caller& caller) {
  const Shown shown(outcome, caller);
  nlohmann::json value = nlohmann::json::parse(outcome.out, nullptr, false);
  REQUIRE_FALSE(value.is_discarded());
  return value;
}

std::vector<std::string> codes_in(const nlohmann::json& messages) {
  std::vector<std::string> codes;
  for (const nlohmann::json& message : messages) codes.push_back(message.at("code"));
  return codes;
}

void check_cases(const std::function<Outcome(const std::string&)>& ask,
                 const std::vector<Case>& cases, const Caller& caller) {
  for (const Case& one : cases) {
    const Outcome outcome = ask(one.arguments);
    const bool refused = one.exit_code >= 2 && one.exit_code <= 4;
    const bool is_silent = refused && one.out == kAnything && one.json.empty();
    check_outcome(outcome, one.exit_code, one.err, is_silent ? "" : one.out, caller);
    if (one.json.empty()) continue;
    const Shown shown(outcome, caller);
    check_json_text(outcome.out, one.json, caller);
  }
}

Outcome Workplace::run(const std::string& arguments, const std::filesystem::path& pipe) const {
  return run_program(folder, arguments, pipe);
}

Outcome Workplace::succeed(const std::string& arguments, const Caller& caller) const {
  return require_success(run(arguments), caller);
}

nlohmann::json Workplace::answer(const std::string& arguments, const Caller& caller) const {
  return json_of(succeed(arguments, caller), caller);
}

void Workplace::check(const std::vector<Case>& cases, const Caller& caller) const {
  check_cases([this](const std::string& arguments) { return run(arguments); }, cases, caller);
}

void Workplace::put(const std::string& name, const std::string& bytes) const {
  put_bytes(folder / name, bytes);
}

}  // namespace clearway::test
