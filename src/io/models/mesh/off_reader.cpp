#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/text/table_header.hpp"

namespace clearway {
namespace {

/// Parses OFF files. Source: Geomview manual, section OFF files.
class OffParser {
 public:
  explicit OffParser(InputBuffer& input) : input_(input), mesh_(input.name()) {}

  MeshFile parse() {
    input_.begin_text();
    read_header();
    for (std::uint64_t i = 0; i < vertices_; ++i) read_vertex(i);
    for (std::uint64_t i = 0; i < faces_; ++i) read_face(i);
    mesh_.remarks().last_line_open = !input_.line_terminated();
    if (next_line()) {
      fail("more than the " + std::to_string(vertices_) + " vertices and " +
           std::to_string(faces_) + " faces that the file declares; expected its end");
    }
    MeshFile out = mesh_.finish();
    out.unit = unit_;
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { mesh_.refuse_at(here(), what); }
  FilePlace here() const { return {"line", input_.line()}; }

  /// Reads the words of the next line that has any, apart from comments; returns false at the end.
  bool next_line() {
    do {
      if (!input_.next_line(line_)) return false;
      const std::size_t comment = std::min(line_.find('#'), line_.size());
      take_unit(line_.substr(comment));
      line_ = line_.substr(0, comment);
      split_fields(line_, ' ', words_);
    } while (words_.empty());
    return true;
  }

  /// Takes the unit from a comment that gives it.
  void take_unit(std::string_view comment) {
    const std::size_t at = comment.find(kUnitComment);
    if (at == std::string_view::npos || comment.find_first_not_of("# ") != at) return;
    split_fields(comment.substr(at + kUnitComment.size()), ' ', words_);
    const auto unit = words_.size() == 1 ? file_unit_of(words_[0]) : std::nullopt;
    if (!unit) fail(excerpt(comment) + "; expected the unit " + file_unit_list());
    unit_ = *unit;
  }

  void need_line(const std::string& expected) {
    if (next_line()) return;
    refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + "; expected " +
                              expected + ". The file may be cut");
  }

  void read_header() {
    need_line("`OFF`");
    const std::size_t letters = words_[0].find_first_of("0123456789+-.", 1);
    const std::string_view keyword =
        words_[0].substr(0, words_[0].ends_with("OFF") ? words_[0].size() : letters);
    if (keyword.ends_with("OFF")) {
      check_keyword(keyword);
      words_[0].remove_prefix(keyword.size());
      if (words_[0].empty()) words_.erase(words_.begin());
      if (words_.empty()) need_line("the numbers of vertices, faces and edges");
    }
    if (words_.size() != 3 && words_.size() != 2) {
      fail(excerpt(line_) + "; expected the numbers of vertices, faces and edges");
    }
    vertices_ = whole(words_[0]);
    faces_ = whole(words_[1]);
  }

  /// Checks the keyword. Texture coordinates, colours and normals follow the coordinates and are
  /// not read.
  void check_keyword(std::string_view keyword) const {
    if (keyword.find_first_not_of("STCNOF") != std::string_view::npos) {
      fail(excerpt(keyword) + "; expected OFF, COFF or NOFF, in three dimensions");
    }
    if (words_.size() > 1 && words_[1] == "BINARY") {
      fail("binary OFF is not read; expected the text form. Export the model as STL, OBJ or PLY");
    }
  }

  std::uint64_t whole(std::string_view word) const {
    const auto value = parse_count(word);
    if (!value) fail(excerpt(word) + "; expected a whole number from 0");
    return *value;
  }

  void read_vertex(std::uint64_t index) {
    need_line("vertex " + std::to_string(index) + " of " + std::to_string(vertices_));
    Vec3 vertex{};
    bool valid = words_.size() >= 3;
    for (std::size_t k = 0; valid && k < words_.size(); ++k) {
      const auto value = parse_whole_number(words_[k]);
      valid = value.has_value();
      if (value && k < 3) vertex[static_cast<int>(k)] = *value;
    }
    if (!valid) fail(excerpt(line_) + "; expected the coordinates X Y Z of a vertex");
    mesh_.add_vertex(vertex, here());
  }

  void read_face(std::uint64_t index) {
    need_line("face " + std::to_string(index) + " of " + std::to_string(faces_));
    const std::uint64_t corners = whole(words_[0]);
    if (corners > words_.size() - 1) {
      fail("a face with " + std::to_string(words_.size() - 1) + " corners; expected " +
           std::to_string(corners) + " as its first number says");
    }
    corners_.clear();
    for (std::size_t i = 1; i <= corners; ++i) {
      const std::uint64_t corner = whole(words_[i]);
      if (corner >= vertices_) {
        fail("a face names vertex " + std::to_string(corner) + "; expected 0 to " +
             std::to_string(vertices_ == 0 ? 0 : vertices_ - 1));
      }
      corners_.push_back(static_cast<std::int64_t>(corner));
    }
    if (corners == 1) return mesh_.add_point(corners_[0], here());
    if (corners == 2) return mesh_.add_line(corners_, here());
    mesh_.add_face(corners_, here());
  }

  InputBuffer& input_;
  MeshBuilder mesh_;
  FileUnit unit_;
  std::string_view line_;
  std::vector<std::string_view> words_;
  std::vector<std::int64_t> corners_;
  std::uint64_t vertices_ = 0, faces_ = 0;  ///< declared numbers
};

}  // namespace

MeshFile read_off(InputBuffer input) { return OffParser(input).parse(); }

}  // namespace clearway
