// Asks the program what the texts beside this file ask, and checks its answers. README.md says how
// they are written. Called with the texts to run, and then with options of Catch.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "catch_session.hpp"
#include "support/catch.hpp"
#include "support/classed_scans.hpp"
#include "tools/cli/support/program.hpp"

namespace clearway::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// The folder of real scans, or nothing.
std::string data_folder() {
  const char* const folder = std::getenv("CLEARWAY_TEST_DATA");
  return folder == nullptr ? "" : folder;
}

/// A factor for peaks of memory, because sanitizers take memory of their own.
#ifdef CLEARWAY_SANITIZED
constexpr const char* kMeasured = "0";
#else
constexpr const char* kMeasured = "1";
#endif

/// A line of a text that begins with a word, and the lines below it that are further indented.
struct Statement {
  std::string place;  ///< file and line
  std::string word, rest;
  std::vector<std::string> rows = {};  ///< lines below it that begin with "|", without that
  std::vector<Statement> body = {};
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

class Parser {
 public:
  explicit Parser(const fs::path& file) : name_(file.filename().string()), text_(bytes_of(file)) {
    std::string line;
    while (std::getline(text_, line)) lines_.push_back(line);
  }

  std::vector<Statement> parse() { return block(0); }

 private:
  static std::size_t indent_of(const std::string& line) { return line.find_first_not_of(' '); }
  static bool says_nothing(const std::string& line) {
    const std::size_t at = indent_of(line);
    return at == std::string::npos || line[at] == '#';
  }

  /// The statements that are indented by at least `least`, up to the first that is not.
  std::vector<Statement> block(std::size_t least) {
    std::vector<Statement> statements;
    for (; next_ < lines_.size(); ++next_) {
      const std::string& line = lines_[next_];
      if (says_nothing(line)) continue;
      const std::size_t indent = indent_of(line);
      if (indent < least) break;
      const std::string text = line.substr(indent);
      const std::size_t end = std::min(text.find(' '), text.size());
      Statement statement{place(), text.substr(0, end), trimmed(text.substr(end))};
      ++next_;
      take_rows(indent, statement);
      statement.body = block(indent + 1);
      --next_;
      statements.push_back(std::move(statement));
    }
    return statements;
  }

  /// Takes the rows that follow at once. One space after the bar is no part of a row.
  void take_rows(std::size_t indent, Statement& statement) {
    for (; next_ < lines_.size(); ++next_) {
      const std::string& line = lines_[next_];
      if (says_nothing(line)) continue;
      const std::size_t at = indent_of(line);
      if (at <= indent || line[at] != '|') return;
      const std::size_t begin = at + (line.substr(at + 1, 1) == " " ? 2 : 1);
      statement.rows.push_back(line.substr(begin));
    }
  }

  std::string place() const { return name_ + ":" + std::to_string(next_ + 1); }

  std::string name_;
  std::istringstream text_;
  std::vector<std::string> lines_;
  std::size_t next_ = 0;
};

using Variables = std::map<std::string, std::string>;

std::string replaced(std::string text, const Variables& variables) {
  for (const auto& [name, value] : variables) {
    const std::string key = "{" + name + "}";
    for (std::size_t at = 0; (at = text.find(key, at)) != std::string::npos; at += value.size()) {
      text.replace(at, key.size(), value);
    }
  }
  return text;
}

/// The parts of a text between separators, without the spaces around them.
std::vector<std::string> parts_of(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    begin = end + std::max<std::size_t>(separator.size() - 1, 1);
  }
  return parts;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// What a set-up has made: files, and names of texts.
struct Made {
  ScratchFolder folder = {};
  Variables known = {};
};

/// A text: what is made once, and the tests. Set-ups of `shared/scenes.test` are those of every
/// text.
struct Text {
  explicit Text(const fs::path& file) : name(file.stem().string()), all(Parser(file).parse()) {
    const fs::path shared = file.parent_path() / "shared" / "scenes.test";
    for (Statement& setup : Parser(shared).parse()) all.push_back(std::move(setup));
  }

  std::string name;
  std::vector<Statement> all;
  std::map<std::string, std::unique_ptr<Made>> made = {};  ///< by set-ups
};

/// Runs the statements of one test, or of a set-up, in a folder.
class Run {
 public:
  Run(Text& text, const ScratchFolder& folder) : text_(text), folder_(folder) {}

  const Variables& known() const { return known_; }

  void body(const std::vector<Statement>& statements, const Variables& variables) {
    for (std::size_t i = 0; i < statements.size(); ++i) {
      const RowName place(statements[i].place);
      if (statements[i].word == ">" || statements[i].word == "?") {
        ask(statements, i, variables);
      } else {
        step(statements[i], variables);
      }
    }
  }

 private:
  /// Asks the program what a statement says, or once with each of its rows.
  void ask(const std::vector<Statement>& statements, std::size_t i, const Variables& variables) {
    const Statement& asked = statements[i];
    bool may_print = false;
    for (std::size_t k = i + 1; k < statements.size(); ++k) {
      if (statements[k].word == ">" || statements[k].word == "?") break;
      may_print = may_print || statements[k].word == "out" || statements[k].word == "json";
    }
    if (asked.rows.empty()) ask_one(asked.word, filled(asked.rest, variables), may_print);
    for (const std::string& row : asked.rows) {
      const RowName shown(row);
      ask_one(asked.word, filled(asked.rest + " " + row, variables), may_print);
    }
  }

  /// `ARGUMENTS => CODE WORDS`: the exit code and what the program says. A program that refuses
  /// leaves no output, and prints messages alone, unless a check that follows says what it prints.
  void ask_one(const std::string& word, const std::string& text, bool may_print) {
    const std::size_t arrow = std::min(text.rfind(" => "), text.size());
    const auto [arguments, pipe] = split_input(text.substr(0, arrow));
    std::size_t digits = 0;
    const std::string expected = arrow < text.size() ? text.substr(arrow + 4) : "0";
    const int code = std::stoi(expected, &digits);
    const std::string words = trimmed(expected.substr(digits));
    const bool refuses = code >= 2 && code <= 4;
    const std::string output = output_of(arguments);
    std::vector<std::string> absent = {output, output + ".partial"};
    std::erase_if(absent, [&](const std::string& name) {
      return output.empty() || fs::exists(fs::symlink_status(folder_ / name));
    });
    outcome_ = run_program(folder_, arguments, pipe);
    check_outcome(outcome_, code, words.empty() ? kAnything : words,
                  refuses && !may_print ? "" : kAnything);
    for (const std::string& name : absent) {
      if (refuses && fs::is_regular_file(folder_ / name)) fail_check(name + " was left");
    }
    if (word == "?") try_properties(arguments);
  }

  /// Tries what holds of every question: `run` with these arguments, which has ended. Two
  /// properties are drawn by CLEARWAY_DRAW, such as a commit, and the question; all where it is not
  /// set, or empty.
  void try_properties(const std::string& arguments) const {
    using Property = void (Run::*)(const std::string& arguments) const;
    const std::pair<const char*, Property> all[] = {
        {"one thread has the same bytes", &Run::with_one_thread},
        {"parts that are merged have the same bytes", &Run::in_parts},
        {"a run that is resumed leaves its result as it is", &Run::resumed},
        {"its result is sound", &Run::verified}};
    const char* const draw = std::getenv("CLEARWAY_DRAW");
    const bool draws = draw != nullptr && *draw != 0;
    const std::size_t first = draws ? std::hash<std::string>()(draw + arguments) : 0;
    const std::size_t count = draws ? 2 : std::size(all);
    for (std::size_t i = 0; i < count; ++i) {
      const auto& [name, holds] = all[(first + i) % std::size(all)];
      const RowName property(name);
      (this->*holds)(arguments);
    }
    put_bytes(folder_ / "stdout.txt", outcome_.out);
    put_bytes(folder_ / "stderr.txt", outcome_.err);
  }

  /// The arguments of a question without some options, and with others.
  static std::string changed(const std::string& arguments, const std::string& more) {
    static const std::regex left_out(" (--force|--json|--resume|--fail-on-collision|-o \\S+)");
    return std::regex_replace(arguments, left_out, "") + " " + more;
  }
  static std::string output_of(const std::string& arguments) {
    std::smatch found;
    return std::regex_search(arguments, found, std::regex(" -o (\\S+)")) ? found.str(1) : "";
  }
  void check_same_result(const std::string& arguments, const std::string& other) const {
    check_same(bytes_of(folder_ / other), bytes_of(folder_ / output_of(arguments)));
    fs::remove(folder_ / other);
  }

  void with_one_thread(const std::string& arguments) const {
    require_success(run_program(folder_, changed(arguments, "-o tried.h5 --threads 1")));
    check_same_result(arguments, "tried.h5");
  }
  void in_parts(const std::string& arguments) const {
    for (const std::string part : {"1", "2", "3"}) {
      require_success(run_program(
          folder_, changed(arguments, "-o tried" + part + ".h5 --shard " + part + "/3")));
    }
    require_success(run_program(folder_, "merge tried2.h5 tried1.h5 tried3.h5 -o tried.h5"));
    check_same_result(arguments, "tried.h5");
    for (const char* part : {"tried1.h5", "tried2.h5", "tried3.h5"}) fs::remove(folder_ / part);
  }
  void resumed(const std::string& arguments) const {
    const std::string output = output_of(arguments), before = bytes_of(folder_ / output);
    require_success(run_program(folder_, changed(arguments, "--resume -o " + output)));
    check_same(bytes_of(folder_ / output), before);
  }
  void verified(const std::string& arguments) const {
    require_success(run_program(folder_, "verify " + output_of(arguments)));
  }

  /// A text in which variables have their values.
  std::string filled(const std::string& text, const Variables& variables) const {
    return replaced(replaced(text, variables), known_);
  }

  static std::pair<std::string, fs::path> split_input(const std::string& arguments) {
    const std::size_t at = arguments.rfind(" < ");
    if (at == std::string::npos) return {arguments, {}};
    return {arguments.substr(0, at), trimmed(arguments.substr(at + 3))};
  }

  void step(const Statement& statement, const Variables& variables) {
    const std::string& word = statement.word;
    const std::string rest = filled(statement.rest, variables);
    const std::vector<std::string> words = words_of(rest);
    std::string text;
    for (const std::string& row : statement.rows) text += filled(row, variables) + "\n";
    if (word == "$") return shell(rest);
    if (word == "use") return use(rest);
    if (word == "for") return repeat(statement, rest, variables);
    if (word == "put") return put_bytes(folder_ / rest, text);
    if (word == "out") return check_says(outcome_.out, rest);
    if (word == "err") return check_says(outcome_.err, rest);
    if (word == "without") return check_lacks(outcome_.err + outcome_.out, rest);
    if (word == "json") return check_json_text(outcome_.out, rest.empty() ? text : rest);
    if (word == "holds") return check_holds(rest, words);
    if (word == "read") {
      outcome_.out = bytes_of(folder_ / rest);
      return;
    }
    if (word == "las") {
      return put_las(folder_ / words.at(0), words.size() > 1 ? bytes_of(folder_ / words[1]) : text);
    }
    if (word == "call") {
      known_[words.at(0)] = trimmed(rest.substr(words[0].size()));
      return;
    }
    if (word == "near") {
      const double number = std::stod(words.at(1));
      const double tolerance = words.size() > 2 ? std::stod(words[2]) : 1e-5 * std::abs(number);
      return check_near(json_of(outcome_), words.at(0), number, tolerance);
    }
    if (word == "let") return let(words.at(0), words.at(1));
    if (word == "warnings") return check_equal(codes_in(json_of(outcome_).at("warnings")), words);
    if (word == "same") {
      return check_same(bytes_of(folder_ / words.at(0)), bytes_of(folder_ / words.at(1)));
    }
    if (word == "text") {
      return check_says(bytes_of(folder_ / words.at(0)), trimmed(rest.substr(words[0].size())));
    }
    if (word == "absent") {
      for (const std::string& name : words) {
        if (fs::exists(fs::symlink_status(folder_ / name))) fail_check(name + " exists");
      }
      return;
    }
    fail_check("'" + word + "' is no statement");
  }

  /// Gives a variable the value at a pointer of the JSON that was printed.
  void let(const std::string& name, const std::string& pointer) {
    const json value = json_of(outcome_).at(pointer_of(pointer));
    known_[name] = value.is_string() ? value.get<std::string>() : value.dump();
  }

  /// `A + B < C`: values are numbers and JSON pointers; `#POINTER` counts what a list or object
  /// has.
  void check_holds(const std::string& text, const std::vector<std::string>& words) const {
    const json found = json_of(outcome_);
    const auto value = [&](const std::string& word) {
      if (word[0] == '#') return static_cast<double>(found.at(pointer_of(word.substr(1))).size());
      return word[0] == '/' ? found.at(pointer_of(word)).get<double>() : std::stod(word);
    };
    double sums[2] = {value(words.at(0)), 0};
    int side = 0;
    std::string relation;
    for (std::size_t i = 1; i + 1 < words.size(); i += 2) {
      const std::string& sign = words[i];
      const double next = value(words[i + 1]);
      if (sign == "+" || sign == "-") {
        sums[side] += sign == "+" ? next : -next;
      } else if (sign == "*") {
        sums[side] *= next;
      } else {
        relation = sign;
        sums[side = 1] = next;
      }
    }
    const bool holds = relation == "<"    ? sums[0] < sums[1]
                       : relation == "<=" ? sums[0] <= sums[1]
                       : relation == ">"  ? sums[0] > sums[1]
                       : relation == ">=" ? sums[0] >= sums[1]
                                          : relation == "=" && sums[0] == sums[1];
    if (!holds) fail_check(text + ": " + std::to_string(sums[0]) + ", " + std::to_string(sums[1]));
  }

  /// Writes a LAS file with steps of a millimetre of rows with x, y and z in steps, and a class.
  static void put_las(const fs::path& path, const std::string& rows) {
    std::istringstream in(rows);
    std::vector<Quantum> points;
    std::vector<std::uint8_t> classes;
    int point_class = 0;
    for (Quantum p{}; in >> p[0] >> p[1] >> p[2] >> point_class; points.push_back(p)) {
      classes.push_back(static_cast<std::uint8_t>(point_class));
    }
    write_classed(path, points, classes, 0, {});
  }

  static json::json_pointer pointer_of(const std::string& text) { return json::json_pointer(text); }

  void shell(const std::string& command) {
    const std::string line =
        "cd " + quoted(folder_ / "") + " && exec > /dev/null && { " + command + "; }";
    if (std::system(line.c_str()) != 0) fail_check("the shell failed");
  }

  /// Copies what a set-up has made, which is done when it is first used.
  void use(const std::string& name) {
    std::unique_ptr<Made>& made = text_.made[name];
    if (made == nullptr) {
      const auto setup = std::ranges::find_if(
          text_.all, [&](const Statement& one) { return one.word == "setup" && one.rest == name; });
      if (setup == text_.all.end()) return fail_check("no set-up is called '" + name + "'");
      made = std::make_unique<Made>();
      Run run(text_, made->folder);
      run.body(setup->body, {});
      made->known = run.known();
    }
    fs::copy(made->folder / "", folder_ / "", fs::copy_options::recursive);
    known_.insert(made->known.begin(), made->known.end());
  }

  /// `for NAME in VALUES`, or `for NAME, NAME in` with a row of values for each turn.
  void repeat(const Statement& statement, const std::string& rest, const Variables& variables) {
    const std::size_t in = rest.find(" in");
    const std::vector<std::string> names = parts_of(rest.substr(0, in), ",");
    std::vector<std::vector<std::string>> turns;
    for (const std::string& row : statement.rows) {
      turns.push_back(parts_of(filled(row, variables) + " ", " ; "));
    }
    for (const std::string& value : words_of(rest.substr(std::min(in + 3, rest.size())))) {
      turns.push_back({value});
    }
    if (turns.empty()) fail_check("no values");
    for (const std::vector<std::string>& values : turns) {
      if (values.size() != names.size()) {
        fail_check(std::to_string(values.size()) + " values for " + std::to_string(names.size()));
        continue;
      }
      Variables here = variables;
      std::string shown;
      for (std::size_t i = 0; i < names.size(); ++i) {
        here[names[i]] = values[i];
        shown += names[i] + " = " + values[i] + " ";
      }
      const RowName turn(shown);
      body(statement.body, here);
    }
  }

  Text& text_;
  const ScratchFolder& folder_;
  Outcome outcome_{};
  Variables known_{{"program", CLEARWAY_PROGRAM},
                   {"python", CLEARWAY_PYTHON3},
                   {"measured", kMeasured},
                   {"data", data_folder()}};  ///< also what `let` has set
};

std::vector<Text>& texts() {
  static std::vector<Text> all;
  return all;
}

}  // namespace
}  // namespace clearway::test

using namespace clearway::test;

TEST_CASE("commands") {
  REQUIRE_FALSE(texts().empty());
  for (Text& text : texts()) {
    for (const Statement& statement : text.all) {
      if (statement.word == "setup" || statement.word == "data") continue;
      DYNAMIC_SECTION(text.name << ": " << statement.rest) {
        if (statement.word != "test") fail_check(statement.place + ": expected a test");
        const ScratchFolder folder;
        Run(text, folder).body(statement.body, {});
      }
    }
  }
}

int main(int count, char** arguments) {
  const std::string ending = ".test";
  int texts_end = 1;
  for (; texts_end < count && std::string(arguments[texts_end]).ends_with(ending); ++texts_end) {
    texts().emplace_back(std::filesystem::path(arguments[texts_end]));
  }
  for (const Text& text : texts()) {
    if (text.all.at(0).word == "data" && data_folder().empty()) return 77;
  }
  arguments[texts_end - 1] = arguments[0];
  return run_catch(count - texts_end + 1, arguments + texts_end - 1);
}
