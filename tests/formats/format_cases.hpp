#pragma once

#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/bytes/pcd_bytes.hpp"

/// The rows of *.case: small files, and what has to be read from them or why they are refused.
///
///   let NAME = TEXT         {NAME} stands for TEXT in everything below
///   = a sentence            begins a block, which has its own settings
///   read KIND               points (unless set otherwise), mesh, pose, frames, and
///                           those that crs.case, geotiff.case and e57.case explain
///   file NAME               the name of the file that the rows are written to
///   columns 2 3 4           the columns of x, y and z that the caller chooses
///   beside NAME = TEXT      another file in the folder
///   start TEXT, end TEXT    stands before, or behind, the text of every row
///   newline TEXT            is written for every \n
///   near NUMBER             the tolerance of numbers; they are equal unless it is set
///   each NAME = A ~ B ~ C   the rows are tried with each of these; several names stand for words
///   TEXT => FACT | FACT     a row
///   # a comment
///
/// TEXT has the escapes \n, \r, \t, \s (a blank), \\ and \xHH; {f32 1 2} for numbers in binary (i8
/// to u64, f32 and f64; >f32 is big-endian); {9*TEXT} for repeated text; {A ~ B} for one of
/// several. FACT is `refused WORDS`, the points with commas between, or a name and what it is;
/// `remark` is the next remark as "note CODE: TEXT [NAME NUMBER]", and a row that names none has
/// none. WORDS are those of check_says().
namespace clearway::test {

using Names = std::map<std::string, std::string>;

/// A file and what is to be read from it.
struct FormatCase {
  std::string title, name, bytes, facts;
  Names settings;
  Names beside;  ///< the bytes of other files, by name

  std::string setting(const std::string& key, const std::string& otherwise = "") const {
    const auto found = settings.find(key);
    return found == settings.end() ? otherwise : found->second;
  }
};

inline std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t at = 0;
  for (std::size_t end; (end = text.find(separator, at)) != text.npos;
       at = end + separator.size()) {
    parts.push_back(text.substr(at, end - at));
  }
  parts.push_back(text.substr(at));
  return parts;
}

/// The texts between tildes, without blanks around them.
inline std::vector<std::string> choices_of(const std::string& text) {
  std::vector<std::string> choices = split(" " + text + " ", " ~ ");
  for (std::string& choice : choices) {
    choice.erase(0, choice.find_first_not_of(' '));
    choice.erase(choice.find_last_not_of(' ') + 1);
  }
  return choices;
}

inline std::string unescaped(const std::string& text) {
  static const std::map<char, char> kEscapes{
      {'n', '\n'}, {'r', '\r'}, {'t', '\t'}, {'s', ' '}, {'\\', '\\'}};
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes += text[i];
    } else if (text.at(++i) == 'x') {
      bytes += static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16));
      i += 2;
    } else {
      bytes += kEscapes.at(text[i]);
    }
  }
  return bytes;
}

template <typename Number>
std::string binary(double value) {
  return raw(static_cast<Number>(value));
}

/// What stands for {words}: a text of that name, a repeated text, or numbers.
inline std::string expanded(const std::string& words, const Names& names) {
  if (const auto named = names.find(words); named != names.end()) return named->second;
  std::string out;
  if (const std::size_t star = words.find('*'); star != words.npos) {
    for (int i = std::stoi(words); i > 0; --i) out += words.substr(star + 1);
    return out;
  }
  static const std::map<std::string, std::string (*)(double)> kTypes{
      {"i8", binary<std::int8_t>},   {"u8", binary<std::uint8_t>},
      {"i16", binary<std::int16_t>}, {"u16", binary<std::uint16_t>},
      {"i32", binary<std::int32_t>}, {"u32", binary<std::uint32_t>},
      {"i64", binary<std::int64_t>}, {"u64", binary<std::uint64_t>},
      {"f32", binary<float>},        {"f64", binary<double>}};
  const bool big = words[0] == '>';
  std::istringstream in(words.substr(big ? 1 : 0));
  std::string type;
  in >> type;
  for (std::string number; in >> number;) {
    std::string bytes = kTypes.at(type)(std::stod(number));
    if (big) bytes.assign(bytes.rbegin(), bytes.rend());
    for (const unsigned char c : bytes) {
      constexpr const char* kDigits = "0123456789ABCDEF";
      out += {'\\', 'x', kDigits[c / 16], kDigits[c % 16]};
    }
  }
  return out;
}

inline std::string with_names(std::string text, const Names& names) {
  for (std::size_t end; (end = text.find('}')) != text.npos;) {  // the innermost one first
    const std::size_t begin = text.rfind('{', end);
    text.replace(begin, end + 1 - begin, expanded(text.substr(begin + 1, end - begin - 1), names));
  }
  return text;
}

/// The cases of a file.
class FormatCases {
 public:
  FormatCases(const std::string& path, std::function<void(const FormatCase&)> use)
      : use_(std::move(use)) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error("no file " + path);
    Names all;  // settings before the first block are those of all blocks
    std::string title;
    for (std::string line; std::getline(file, line);) {
      const std::size_t arrow = line.find(" => ");
      if (line.empty() || (line[0] == '#' && arrow == line.npos)) continue;
      if (arrow != line.npos) {
        add(settings_.begin(), names_, line.substr(0, arrow),
            {title, "", "", line.substr(arrow + 4), {}, {}});
        continue;
      }
      if (line.starts_with("= ")) {
        if (title.empty()) all = settings_;
        settings_ = all;
        title = line.substr(2);
        continue;
      }
      // KEY VALUE or KEY NAME = VALUE
      const bool named =
          line.starts_with("let ") || line.starts_with("each ") || line.starts_with("beside ");
      const std::size_t cut = named ? line.find(" = ") : line.find(' ');
      const std::string key = line.substr(0, cut), value = line.substr(cut + (named ? 3 : 1));
      if (key.starts_with("let ")) {
        names_[key.substr(4)] = with_names(value, names_);
      } else {
        settings_[key] = value;
      }
    }
  }

 private:
  /// Adds the row with all choices, of the settings from `next` on and of its own.
  void add(Names::const_iterator next, Names names, const std::string& row, FormatCase one) {
    while (next != settings_.end() && !next->first.starts_with("each ")) ++next;
    if (next != settings_.end()) {
      const auto words = split(next->first.substr(5), " ");
      const auto choices = choices_of(next->second);
      ++next;
      for (const std::string& choice : choices) {
        const auto values = words.size() == 1 ? std::vector{choice} : split(choice + " ", " ");
        for (std::size_t i = 0; i < words.size(); ++i) {
          names[words[i]] = with_names(values.at(i), names);
        }
        add(next, names, row, one);
      }
      return;
    }
    if (const std::size_t tilde = row.find(" ~ "); tilde != row.npos) {
      const auto brace_around = [&](std::size_t at, std::size_t step, char brace, char other) {
        for (int depth = 0; row[at] != brace || depth > 0; at += step) {
          depth += row[at] == other ? 1 : row[at] == brace ? -1 : 0;
        }
        return at;
      };
      const std::size_t begin = brace_around(tilde, -1, '{', '}');
      const std::size_t end = brace_around(tilde, 1, '}', '{');
      for (const std::string& choice : choices_of(row.substr(begin + 1, end - begin - 1))) {
        add(next, names, row.substr(0, begin) + choice + row.substr(end + 1), one);
      }
      return;
    }
    for (const auto& [key, value] : settings_) {
      if (key.starts_with("beside ")) {
        one.beside[with_names(key.substr(7), names)] = unescaped(with_names(value, names));
      } else {
        one.settings[key] = with_names(value, names);
      }
    }
    std::string text = one.setting("start") + with_names(row, names) + one.setting("end");
    one.title += ": " + text.substr(0, 300);
    const std::string newline = one.setting("newline", "\\n");
    for (std::size_t at = 0; (at = text.find("\\n", at)) != text.npos; at += newline.size()) {
      text.replace(at, 2, newline);
    }
    one.name = one.setting("file", "a.txt");
    one.bytes = unescaped(text);
    one.facts = with_names(one.facts, names);
    use_(one);
  }

  std::function<void(const FormatCase&)> use_;
  Names names_, settings_;
};

}  // namespace clearway::test
