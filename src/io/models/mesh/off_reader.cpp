#include <optional>
#include <string>
#include <string_view>

#include "io/models/mesh/mesh_reader.hpp"
#include "io/models/mesh/mesh_text.hpp"
#include "io/scans/length_unit.hpp"

namespace clearway {
namespace {

/// Parses OFF files. Source: Geomview manual, section OFF files.
class OffParser : MeshText {
 public:
  explicit OffParser(InputBuffer& input) : MeshText(input, '#') {}

  MeshFile parse() {
    input_.begin_text();
    read_header();
    for (std::uint64_t i = 0; i < vertices_; ++i) {
      need("vertex " + std::to_string(i) + " of " + std::to_string(vertices_));
      mesh_.add_vertex(coordinates(0, words_.size(), "the coordinates X Y Z of a vertex"), here_);
    }
    for (std::uint64_t i = 0; i < faces_; ++i) read_face(i);
    mesh_.remarks().last_line_open = !input_.line_terminated();
    if (next()) {
      fail("more than the " + std::to_string(vertices_) + " vertices and " +
           std::to_string(faces_) + " faces that the file declares; expected its end");
    }
    return mesh_.finish();
  }

 private:
  /// Takes the unit from a comment that gives it.
  void take_comment(std::string_view comment) override {
    const std::size_t at = comment.find(kUnitComment);
    if (at == std::string_view::npos || comment.find_first_not_of("# ") != at) return;
    split_fields(comment.substr(at + kUnitComment.size()), ' ', words_);
    const auto unit = words_.size() == 1 ? file_unit_of(words_[0]) : std::nullopt;
    if (!unit) fail(excerpt(comment) + "; expected the unit " + file_unit_list());
    mesh_.set_unit(*unit);
  }

  void read_header() {
    need("`OFF`");
    const std::size_t letters = words_[0].find_first_of("0123456789+-.", 1);
    const std::string_view keyword =
        words_[0].substr(0, words_[0].ends_with("OFF") ? words_[0].size() : letters);
    if (keyword.ends_with("OFF")) {
      check_keyword(keyword);
      words_[0].remove_prefix(keyword.size());
      if (words_[0].empty()) words_.erase(words_.begin());
      if (words_.empty()) need("the numbers of vertices, faces and edges");
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

  void read_face(std::uint64_t index) {
    need("face " + std::to_string(index) + " of " + std::to_string(faces_));
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
    if (corners == 1) return mesh_.add_point(corners_[0], here_);
    if (corners == 2) return mesh_.add_line(corners_, here_);
    mesh_.add_face(corners_, here_);
  }

  std::uint64_t vertices_ = 0, faces_ = 0;  ///< declared numbers
};

}  // namespace

MeshFile read_off(InputBuffer input) { return OffParser(input).parse(); }

}  // namespace clearway
