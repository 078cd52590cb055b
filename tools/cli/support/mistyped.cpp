#include "cli/support/mistyped.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <numeric>
#include <optional>
#include <span>

#include "clearway/error.hpp"
#include "cli/support/lengths.hpp"
#include "io/files/text_number.hpp"

namespace clearway::tool {
namespace {

/// The number of letters to add, drop, change, or swap with the next, to make b of a.
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

  /// The option at the front of the words and its value as one word, where the parser would not see
  /// that they belong together because the value begins with a minus, or is a length whose unit
  /// stands apart, as in --radius 10 cm. Adds the number of joined words to `taken`.
  std::string joined(std::span<const std::string> words, std::size_t& taken) const {
    const std::string& word = words[0];
    const CLI::Option* option = word.starts_with('-') && word.find('=') == std::string::npos
                                    ? command_->get_option_no_throw(word)
                                    : nullptr;
    const std::size_t values = option == nullptr || option->get_lnames().empty()
                                   ? 0
                                   : words_of_value(*option, words.subspan(1));
    taken += 1 + values;
    if (values == 0) return word;
    return "--" + option->get_lnames().front() + "=" + words[1] + (values > 1 ? words[2] : "");
  }

  /// Checks one word. False where the words after it are not to be checked.
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

  /// The number of words after an option that are to be joined to it.
  std::size_t words_of_value(const CLI::Option& option, std::span<const std::string> words) const {
    if (option.get_items_expected_max() == 0 || words.empty()) return 0;
    const std::string& value = words[0];
    if (words.size() > 1 && option.get_type_name() == kLengthType) {
      const std::optional<ParsedLength> bare = length_of(value);
      const std::optional<ParsedLength> whole = length_of(value + words[1]);
      if (bare && !bare->has_unit && whole && whole->has_unit) return 2;
    }
    const bool may_be_value = value.size() > 1 && value[0] == '-' && value[1] != '-';
    return may_be_value && command_->get_option_no_throw(value.substr(0, 2)) == nullptr ? 1 : 0;
  }

  void check_option(const std::string& option) const {
    std::vector<std::string> known;
    for (const CLI::Option* other : command_->get_options()) {
      if (other->check_name(option)) return;
      for (const std::string& name : other->get_lnames()) known.push_back("--" + name);
    }
    throw UsageError("unknown option " + option + advice_on_option(option, known) + " (" + name_ +
                     " --help explains them)");
  }

  /// What to do instead of an option that the command does not have.
  std::string advice_on_option(const std::string& option,
                               const std::vector<std::string>& known) const {
    const std::string& command = command_->get_name();
    const bool reads_result = command == "report" || command == "conflicts" || command == "compare";
    if (option == "--model-as" && reads_result) {
      return "; leave it out, because the result says what the run took the model for, and it is "
             "taken for the same here";
    }
    return did_you_mean(option, known);
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
      if (command->get_group().empty()) continue;  // hidden commands have no group
      known.push_back(command->get_name());
      list += (list.empty() ? "" : ", ") + command->get_name();
    }
    // A command such as `model` takes a file or one of its commands.
    const auto options = command_->get_options();
    if (std::ranges::any_of(options, [](const auto* option) { return option->get_positional(); })) {
      return;
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

std::vector<std::string> checked_words(const CLI::App& program, const char* program_name, int argc,
                                       char** argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  WordCheck check(program, program_name);
  std::vector<std::string> out;
  bool looking = true;
  for (std::size_t i = 0; i < words.size();) {
    if (!looking) {
      out.push_back(words[i++]);
      continue;
    }
    out.push_back(check.joined(std::span(words).subspan(i), i));
    looking = check.accepts(out.back());
  }
  return out;
}

}  // namespace clearway::tool
