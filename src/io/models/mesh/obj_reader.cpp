#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/files/input_error.hpp"
#include "io/files/text_number.hpp"
#include "io/models/mesh/mesh_builder.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/scans/text/table_header.hpp"

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

template <std::size_t kCount>
bool is_among(std::string_view word, const std::string_view (&words)[kCount]) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// Parses OBJ files. Source: Wavefront Technologies, Advanced Visualizer manual, appendix B1,
/// Object files (.obj).
class ObjParser {
 public:
  explicit ObjParser(InputBuffer& input) : input_(input), mesh_(input.name()) {}

  MeshFile parse() {
    if (input_.size() == 0u) refuse(input_.name(), "is empty; expected vertices `v X Y Z`");
    input_.begin_text();
    while (next_statement()) {
      split_fields(statement_, ' ', words_);
      if (!words_.empty()) read_statement();
    }
    mesh_.remarks().last_line_open = !input_.line_terminated() && last_counts_;
    return mesh_.finish();
  }

 private:
  FilePlace here() const { return {"line", line_}; }

  /// Reads the next line, joined with those that continue it, without its comment. Returns false at
  /// the end.
  bool next_statement() {
    std::string_view line;
    if (!input_.next_line(line)) return false;
    line_ = input_.line();
    statement_ = line;
    if (ends_continued(statement_)) join(line);
    statement_ = statement_.substr(0, statement_.find('#'));
    return true;
  }

  static bool ends_continued(std::string_view line) {
    return line.ends_with('\\') && line.find('#') == std::string_view::npos;
  }

  void join(std::string_view line) {
    joined_ = line;
    while (ends_continued(joined_)) {
      joined_.back() = ' ';
      if (!input_.next_line(line)) mesh_.refuse_at(here(), "continues behind the file's end");
      if (joined_.size() + line.size() > kLongestStatement) {
        mesh_.refuse_at(here(), "continues over more than 1 MiB; expected less");
      }
      joined_ += line;
    }
    statement_ = joined_;
  }

  void read_statement() {
    const std::string_view keyword = words_[0];
    last_counts_ = keyword == "v" || keyword == "f" || keyword == "l" || keyword == "p";
    if (keyword == "v") return read_vertex();
    if (keyword == "f" || keyword == "fo") {
      read_corners("a face");
      return mesh_.add_face(corners_, here());
    }
    if (keyword == "l") {
      read_corners("a line");
      return mesh_.add_line(corners_, here());
    }
    if (keyword == "p") return read_points();
    if (is_among(keyword, kIgnored)) return;
    if (is_among(keyword, kFreeForms)) {
      mesh_.refuse_at(here(), excerpt(keyword) +
                                  " is not read; expected vertices and faces alone. Export the "
                                  "model as triangles");
    }
    mesh_.refuse_at(here(),
                    excerpt(statement_) + "; expected an OBJ statement, as `v X Y Z` or `f A B C`");
  }

  /// Reads a vertex: x y z, perhaps followed by a weight, a colour, or both.
  void read_vertex() {
    Vec3 vertex{};
    bool valid = words_.size() >= 4 && words_.size() <= 8;
    for (std::size_t i = 1; valid && i < words_.size(); ++i) {
      const auto value = parse_whole_number(words_[i]);
      valid = value.has_value();
      if (value && i <= 3) vertex[static_cast<int>(i) - 1] = *value;
    }
    if (!valid) mesh_.refuse_at(here(), excerpt(statement_) + "; expected `v X Y Z`");
    mesh_.add_vertex(vertex, here());
  }

  void read_corners(const char* what) {
    corners_.clear();
    for (std::size_t i = 1; i < words_.size(); ++i) corners_.push_back(corner_of(words_[i], what));
  }

  void read_points() {
    read_corners("a point");
    if (corners_.empty()) mesh_.refuse_at(here(), "a point without a vertex; expected `p V`");
    for (const std::int64_t vertex : corners_) mesh_.add_point(vertex, here());
  }

  /// The index from 0 of the vertex in "V", "V/VT", "V//VN" or "V/VT/VN". Indices in the file count
  /// from 1, or backwards from -1.
  std::int64_t corner_of(std::string_view word, const char* what) const {
    std::int64_t index = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, index);
    if (error != std::errc() || (stop != end && *stop != '/')) {
      mesh_.refuse_at(here(), "corner " + excerpt(word) + "; expected `V`, `V/T` or `V/T/N`");
    }
    const auto vertices = static_cast<std::int64_t>(mesh_.vertices());
    if (index == 0 || index > vertices || index < -vertices) {
      mesh_.refuse_at(here(), std::string(what) + " names vertex " + std::to_string(index) +
                                  "; expected 1 to " + std::to_string(vertices) +
                                  ", the number of vertices before this line, or -1 to -" +
                                  std::to_string(vertices));
    }
    return index > 0 ? index - 1 : vertices + index;
  }

  InputBuffer& input_;
  MeshBuilder mesh_;
  std::uint64_t line_ = 0;  ///< line at which the statement starts
  std::string_view statement_;
  std::string joined_;
  std::vector<std::string_view> words_;
  std::vector<std::int64_t> corners_;
  bool last_counts_ = false;  ///< whether the last statement is part of the model
};

}  // namespace

MeshFile read_obj(InputBuffer input) { return ObjParser(input).parse(); }

}  // namespace clearway
