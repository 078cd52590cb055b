#include <algorithm>
#include <charconv>
#include <span>
#include <string>
#include <string_view>

#include "io/models/mesh/mesh_reader.hpp"
#include "io/models/mesh/mesh_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t kLongestStatement = std::size_t{1} << 20;  // bytes, including continued lines

/// Statements that change neither vertices nor faces.
constexpr std::string_view kIgnored[] = {
    "vt",     "vn",         "vp",        "g",      "s",     "o",        "mg",
    "mtllib", "usemtl",     "maplib",    "usemap", "bevel", "c_interp", "d_interp",
    "lod",    "shadow_obj", "trace_obj", "ctech",  "stech"};

/// Statements of free-form curves and surfaces, and commands.
constexpr std::string_view kFreeForms[] = {"curv", "curv2", "surf", "cstype", "deg", "bmat", "step",
                                           "parm", "trim",  "hole", "scrv",   "sp",  "end",  "con",
                                           "bzp",  "bsp",   "cdc",  "cdp",    "res", "call", "csh"};

bool is_among(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

/// Parses OBJ files. Source: Wavefront Technologies, Advanced Visualizer manual, appendix B1,
/// Object files (.obj).
class ObjParser : MeshText {
 public:
  explicit ObjParser(InputBuffer& input) : MeshText(input, '#') {}

  MeshFile parse() {
    if (input_.size() == 0u) refuse(input_.name(), "is empty; expected vertices `v X Y Z`");
    input_.begin_text();
    while (next()) read_statement();
    mesh_.remarks().last_line_open = !input_.line_terminated() && last_counts_;
    return mesh_.finish();
  }

 private:
  static bool ends_continued(std::string_view line) {
    return line.ends_with('\\') && line.find('#') == std::string_view::npos;
  }

  void join(std::string_view& line) override {
    if (!ends_continued(line)) return;
    joined_ = line;
    while (ends_continued(joined_)) {
      joined_.back() = ' ';
      if (!input_.next_line(line)) fail("continues behind the file's end");
      if (joined_.size() + line.size() > kLongestStatement) {
        fail("continues over more than 1 MiB; expected less");
      }
      joined_ += line;
    }
    line = joined_;
  }

  void read_statement() {
    const std::string_view keyword = words_[0];
    last_counts_ = keyword == "v" || keyword == "f" || keyword == "l" || keyword == "p";
    if (keyword == "v") {
      // A weight, a colour, or both may follow the coordinates.
      mesh_.add_vertex(coordinates(1, 8, "`v X Y Z`"), here_);
    } else if (keyword == "f" || keyword == "fo") {
      read_corners("a face");
      mesh_.add_face(corners_, here_);
    } else if (keyword == "l") {
      read_corners("a line");
      mesh_.add_line(corners_, here_);
    } else if (keyword == "p") {
      read_corners("a point");
      if (corners_.empty()) fail("a point without a vertex; expected `p V`");
      for (const std::int64_t vertex : corners_) mesh_.add_point(vertex, here_);
    } else if (is_among(keyword, kFreeForms)) {
      fail(excerpt(keyword) +
           " is not read; expected vertices and faces alone. Export the model as triangles");
    } else if (!is_among(keyword, kIgnored)) {
      fail(excerpt(line_) + "; expected an OBJ statement, as `v X Y Z` or `f A B C`");
    }
  }

  void read_corners(const char* what) {
    corners_.clear();
    for (std::size_t i = 1; i < words_.size(); ++i) corners_.push_back(corner_of(words_[i], what));
  }

  /// The index from 0 of the vertex in "V", "V/VT", "V//VN" or "V/VT/VN". Indices in the file count
  /// from 1, or backwards from -1.
  std::int64_t corner_of(std::string_view word, const char* what) const {
    std::int64_t index = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, index);
    if (error != std::errc() || (stop != end && *stop != '/')) {
      fail("corner " + excerpt(word) + "; expected `V`, `V/T` or `V/T/N`");
    }
    const auto vertices = static_cast<std::int64_t>(mesh_.vertices());
    if (index == 0 || index > vertices || index < -vertices) {
      fail(std::string(what) + " names vertex " + std::to_string(index) + "; expected 1 to " +
           std::to_string(vertices) + ", the number of vertices before this line, or -1 to -" +
           std::to_string(vertices));
    }
    return index > 0 ? index - 1 : vertices + index;
  }

  std::string joined_;
  bool last_counts_ = false;  ///< whether the last statement is part of the model
};

}  // namespace

MeshFile read_obj(InputBuffer input) { return ObjParser(input).parse(); }

}  // namespace clearway
