#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/scans/input_buffer.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {

/// Base of the parsers of meshes in text, which consist of words in lines.
class MeshText {
 protected:
  /// comment: the character that begins a comment; a line break where the format has none.
  MeshText(InputBuffer& input, char comment)
      : input_(input), mesh_(input.name()), comment_(comment) {}
  ~MeshText() = default;

  /// Joins a line with those that continue it, where the format has such lines.
  virtual void join(std::string_view& /*line*/) {}
  /// Takes a comment, which begins with its character.
  virtual void take_comment(std::string_view /*comment*/) {}

  /// Reads the words of the next line that has any; returns false at the end.
  bool next() {
    do {
      if (!input_.next_line(line_)) return false;
      here_.number = input_.line();
      join(line_);
      const std::size_t end = std::min(line_.find(comment_), line_.size());
      if (end < line_.size()) take_comment(line_.substr(end));
      line_ = line_.substr(0, end);
      split_fields(line_, ' ', words_);
    } while (words_.empty());
    return true;
  }

  /// Reads the next words, where the file may not end.
  void need(const std::string& expected) {
    if (next()) return;
    refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + "; expected " +
                              expected + ". The file may be cut");
  }

  [[noreturn]] void fail(const std::string& what) const { mesh_.refuse_at(here_, what); }

  /// The three coordinates that begin with the word `first`. Other numbers may follow, but no more
  /// than `most` words may stand in the line.
  Vec3 coordinates(std::size_t first, std::size_t most, const char* expected) const {
    Vec3 place{};
    bool valid = words_.size() >= first + 3 && words_.size() <= most;
    for (std::size_t i = first; valid && i < words_.size(); ++i) {
      const auto value = parse_whole_number(words_[i]);
      valid = value.has_value();
      if (value && i < first + 3) place[static_cast<int>(i - first)] = *value;
    }
    if (!valid) fail(excerpt(line_) + "; expected " + expected);
    return place;
  }

  InputBuffer& input_;
  MeshBuilder mesh_;
  FilePlace here_{"line", 0};  ///< where the words begin
  std::string_view line_;      ///< without its comment
  std::vector<std::string_view> words_;
  std::vector<std::int64_t> corners_;

 private:
  char comment_;
};

}  // namespace clearway
