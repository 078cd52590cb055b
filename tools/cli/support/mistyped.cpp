#include "cli/support/mistyped.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <numeric>

#include "clearway/error.hpp"

namespace clearway::tool {
namespace {

/// Letters to add, to drop, to change, or to swap with the next, from a to b.
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), now(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + change});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before = last;
    last = now;
  }
  return last.back();
}

std::string did_you_mean(const std::string& typed, const std::vector<std::string>& words) {
  const std::string word = likeliest(typed, words);
  return word.empty() ? "" : "; did you mean " + word + "?";
}

class WordCheck {
 public:
  WordCheck(const CLI::App& program, const char* name) : command_(&program), name_(name) {}

  /// False where the rest is not to be looked at.
  bool accepts(const std::string& word) {
    if (word == "--") return false;
    if (word.size() > 2 && word.starts_with("--")) {
      check_option(word.substr(0, word.find('=')));
    } else if (word.size() == 2 && word[0] == '-' && std::isalpha(uchar(word[1])) != 0) {
      check_option(word);
    } else if (!command_->get_subcommands({}).empty()) {
      enter(word);
      return !command_->get_prefix_command();
    }
    return true;
  }

 private:
  static unsigned char uchar(char c) { return static_cast<unsigned char>(c); }

  void check_option(const std::string& option) const {
    std::vector<std::string> known;
    for (const CLI::Option* other : command_->get_options()) {
      if (other->check_name(option)) return;
      for (const std::string& name : other->get_lnames()) known.push_back("--" + name);
    }
    throw UsageError("unknown option " + option + did_you_mean(option, known) + " (" + name_ +
                     " --help explains them)");
  }

  void enter(const std::string& word) {
    std::vector<std::string> known;
    std::string list;
    for (const CLI::App* command : command_->get_subcommands({})) {
      if (command->get_name() == word) {
        command_ = command;
        name_ += " " + word;
        return;
      }
      if (command->get_group().empty()) continue;  // hidden
      known.push_back(command->get_name());
      list += (list.empty() ? "" : ", ") + command->get_name();
    }
    throw UsageError(word + ": no such command" + did_you_mean(word, known) + "; expected one of " +
                     list + " (" + name_ + " --help explains them)");
  }

  const CLI::App* command_;
  std::string name_;
};

}  // namespace

std::string likeliest(const std::string& typed, const std::vector<std::string>& words) {
  std::string best;
  std::size_t least = std::max<std::size_t>(2, typed.size() / 3) + 1;
  for (const std::string& word : words) {
    const std::size_t here = edits(typed, word);
    if (here < least && here < word.size()) {
      least = here;
      best = word;
    }
  }
  return best;
}

void check_words(const CLI::App& program, const char* program_name, int argc, char** argv) {
  WordCheck check(program, program_name);
  for (int i = 1; i < argc && check.accepts(argv[i]); ++i) {
  }
}

}  // namespace clearway::tool
