#include <strings.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <string_view>

#include "core/util/format.hpp"
#include "io/files/bytes.hpp"
#include "io/models/mesh/mesh_reader.hpp"
#include "io/models/mesh/mesh_text.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text_copy.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kHeaderBytes = 84;    // 80 bytes of text, then the number of triangles
constexpr std::uint64_t kTriangleBytes = 50;  // normal, three vertices, two bytes of any use

MeshFile read_binary_stl(InputBuffer& input, std::uint32_t triangles) {
  MeshBuilder mesh(input.name());
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const std::uint64_t start = input.position();
    const auto bytes = input.take(kTriangleBytes);
    if (bytes.empty()) refuse_byte(input.name(), start, "ends within a triangle");
    std::array<Vec3, 3> corners{};
    const std::byte* at = bytes.data() + 3 * sizeof(float);
    for (Vec3& corner : corners) {
      for (int k = 0; k < 3; ++k, at += sizeof(float)) corner[k] = load<float>(at);
    }
    mesh.add_triangle(corners, {"byte", start});
  }
  return mesh.finish();
}

class AsciiStlParser : MeshText {
 public:
  explicit AsciiStlParser(InputBuffer& input) : MeshText(input, '\n') {}

  MeshFile parse() {
    bool any = false;
    while (next()) {
      expect({"solid"}, "`solid NAME`");
      any = true;
      read_solid();
    }
    if (!any) refuse(input_.name(), "holds no text; expected `solid NAME`");
    return mesh_.finish();
  }

 private:
  bool starts_with(std::initializer_list<std::string_view> keywords) const {
    if (words_.size() < keywords.size()) return false;
    return std::equal(keywords.begin(), keywords.end(), words_.begin(),
                      [](std::string_view keyword, std::string_view word) {
                        return std::ranges::equal(keyword, word, [](char a, char b) {
                          return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b);
                        });
                      });
  }

  void expect(std::initializer_list<std::string_view> keywords, const char* expected) const {
    if (!starts_with(keywords)) fail(excerpt(line_) + "; expected " + expected);
  }

  void read_solid() {
    for (;;) {
      need("`facet` or `endsolid`");
      if (starts_with({"endsolid"}) || starts_with({"end", "solid"})) return;
      expect({"facet"}, "`facet normal X Y Z` or `endsolid`");
      read_facet();
    }
  }

  void read_facet() {
    need("`outer loop`");
    expect({"outer", "loop"}, "`outer loop`");
    std::array<Vec3, 3> corners{};
    for (Vec3& corner : corners) {
      need("`vertex X Y Z`");
      expect({"vertex"}, "`vertex X Y Z`");
      corner = coordinates(1, 4, "`vertex X Y Z`");
    }
    const FilePlace last = here_;
    need("`endloop`");
    expect({"endloop"}, "`endloop` behind three vertices");
    need("`endfacet`");
    expect({"endfacet"}, "`endfacet`");
    mesh_.add_triangle(corners, last);
  }
};

/// The start of a file as that of a binary one: its declared number of triangles, 0 where the file
/// is too short for it.
struct StlStart {
  std::uint32_t triangles = 0;
  bool is_text = false;  ///< whether it begins as the text form does and has no zero byte
};

StlStart start_of(InputBuffer& input) {
  const InputBuffer::Mark start = input.mark();
  const std::size_t count = std::min<std::uint64_t>(*input.size(), 512);
  const auto bytes = input.take(count);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::size_t word = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  StlStart found;
  found.is_text = text.find('\0') == std::string_view::npos && text.size() >= word + 5 &&
                  ::strncasecmp(text.data() + word, "solid", 5) == 0;
  if (count >= kHeaderBytes) found.triangles = load<std::uint32_t>(bytes.data() + 80);
  input.return_to(start);
  return found;
}

}  // namespace

// Reads STL. A file is binary where its size fits the declared number of triangles, because the
// text before that may begin with "solid". Source: 3D Systems, Stereolithography interface
// specification, 1989.
MeshFile read_stl(InputBuffer input) {
  const std::uint64_t size = *input.size();
  const StlStart start = start_of(input);
  const std::uint64_t expected = kHeaderBytes + kTriangleBytes * start.triangles;
  if (size >= kHeaderBytes && size == expected) {
    input.skip(kHeaderBytes);
    refuse_seven_bits(input);
    return read_binary_stl(input, start.triangles);
  }
  if (start.is_text) return AsciiStlParser(input).parse();
  if (size < kHeaderBytes) {
    refuse(input.name(), "has " + std::to_string(size) +
                             " bytes; expected a binary STL file with 84 or more, or text that "
                             "starts with `solid`");
  }
  refuse_if_copied_as_text(input.file());
  const bool longer = size > expected;
  refuse_byte(input.name(), 80, "declares {} triangles, that is {} bytes in all; the file has {}{}",
              start.triangles, expected, size,
              longer ? ", which is " + counted(size - expected, "byte") +
                           " more. Triangles may be missing in the number, or something else "
                           "was appended; export it again"
                     : ". It may be cut; export it again");
}

}  // namespace clearway
