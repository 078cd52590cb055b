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

/// Reads the points of a text ahead, several blocks of lines at the same time. It accepts only
/// whole lines that certainly are points or hold nothing. Everything else stays in the input for a
/// reader that goes line by line and can report what is wrong.
class PointBlocks {
 public:
  enum class Line {
    kPoint,
    kNothing,  ///< a blank line or a comment
    kOther
  };

  /// Parses the points of a block's lines; returns false for a line of another kind.
  using ParseBlock = std::function<bool(std::string_view block, std::vector<Vec3>& points)>;

  /// Makes a ParseBlock of parse(line, point), which returns the kind of a line. It is copied for
  /// each block.
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

  /// Reads on from the input's position and moves it behind what was read. Returns the number of
  /// points; nullopt, with the input where it was, if nothing could be read. most: number of points
  /// that may follow.
  std::optional<std::uint64_t> read(InputBuffer& input, const ParseBlock& parse,
                                    std::uint64_t most);
  /// Appends points that were read to `out`, until it has `size`. Returns how many were appended.
  std::size_t take(std::vector<Vec3>& out, std::size_t size);
  void clear() { parts_.clear(); }

 private:
  struct Part {
    std::vector<Vec3> points;
    std::uint64_t bytes = 0, lines = 0;  ///< length of the part in the text
    bool good = false;
  };

  std::vector<Part> parts_;
  std::size_t part_ = 0, point_ = 0;  ///< indices of the next point to be taken
};

}  // namespace clearway
