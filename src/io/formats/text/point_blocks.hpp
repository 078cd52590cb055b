#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "clearway/vec3.hpp"
#include "io/formats/input_buffer.hpp"
#include "io/formats/text/line_blocks.hpp"

namespace clearway {

/// Reads the points of a text ahead, some blocks of lines at the same time. It takes over what is
/// beyond doubt: whole lines that are points or nothing. Whatever else comes stays in the input,
/// for a reader that goes line by line and knows what to say of it.
class PointBlocks {
 public:
  enum class Line {
    kPoint,
    kNothing,  ///< blank, or a comment
    kOther
  };

  /// The points of a block's lines; false for a line of another kind.
  using ParseBlock = std::function<bool(std::string_view block, std::vector<Vec3>& points)>;

  /// parse(line, point): which kind of line it is. It is copied for each block.
  template <typename Parse>
  static ParseBlock of_lines(const Parse& parse) {
    return [parse](std::string_view block, std::vector<Vec3>& points) {
      Parse own = parse;
      return each_line(block, [&](std::string_view line) {
        Vec3 point{};
        const Line kind = own(line, point);
        if (kind == Line::kPoint) points.push_back(point);
        return kind != Line::kOther;
      });
    };
  }

  /// Reads on from where the input stands, and moves it behind what was read; how many points.
  /// None, and the input stays, where nothing could be read. most: points that may follow.
  std::optional<std::uint64_t> read(InputBuffer& input, const ParseBlock& parse,
                                    std::uint64_t most);
  /// Appends points that were read to `out`, up to `size` in all; how many.
  std::size_t take(std::vector<Vec3>& out, std::size_t size);
  void clear() { parts_.clear(); }

 private:
  struct Part {
    std::vector<Vec3> points;
    std::uint64_t bytes = 0, lines = 0;  ///< of the text
    bool good = false;
  };

  std::vector<Part> parts_;
  std::size_t part_ = 0, point_ = 0;  ///< the next to be taken
};

}  // namespace clearway
