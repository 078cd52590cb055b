#include <string_view>
#include <utility>

#include "io/formats/pcd/pcd_body_reader.hpp"
#include "io/formats/text/open_end.hpp"
#include "io/formats/text/point_line.hpp"
#include "io/formats/text/text_number.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

/// Reads ASCII data with one point per line. Numbers are read as written, even where TYPE promises
/// fewer digits.
class AsciiPcdReader final : public PcdBodyReader {
 public:
  AsciiPcdReader(InputBuffer input, PcdHeader header)
      : PcdBodyReader(std::move(input), std::move(header)) {
    std::array<std::uint64_t, 3> words{};
    for (std::size_t i = 0; i < header_.fields.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (header_.coordinates[axis] == i) words[axis] = words_of_point_;
      }
      words_of_point_ += header_.fields[i].count;
    }
    words_ = words;
    check_room();
  }

  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    rewind();
    std::string_view line;
    return lines_of_points(points, input_, [&] { return next_line(line); });
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    refuse_line(input_.name(), input_.line(), what);
  }

  /// Throws InputError where the file is too small. Each number takes at least two bytes including
  /// its separator, which the last one of the file may lack.
  void check_room() const {
    const std::uint64_t room = *input_.size() - input_.position() + 1;
    if (header_.points <= room / (2 * words_of_point_)) return;
    refuse(input_.name(), "ends at byte " + std::to_string(*input_.size()) + "; expected " +
                              std::to_string(header_.points) + " points of " +
                              std::to_string(words_of_point_) + " numbers");
  }

  void read_points(std::span<Vec3> out) override {
    std::string_view line;
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!next_line(line)) {
        refuse(input_.name(), "ends after line " + std::to_string(input_.line()) + " with " +
                                  std::to_string(next_ + i) + " points; expected " +
                                  std::to_string(header_.points) + " as the header declares");
      }
      parse(line, out[i]);
      open_end_.see(input_, line);
    }
  }

  void start_again() override { open_end_ = OpenEnd(); }

  void check_end() override {
    std::string_view line;
    if (next_line(line)) {
      fail("more than the " + std::to_string(header_.points) + " points that the header declares");
    }
    open_end_.append_to(info_.remarks, input_.name());
  }

  /// Reads the next line that is not blank; returns false at the end.
  bool next_line(std::string_view& line) {
    do {
      if (!input_.next_line(line)) return false;
    } while (skip_blanks(line.data(), line.data() + line.size()) == line.data() + line.size());
    return true;
  }

  void parse(std::string_view line, Vec3& point) const {
    const char* const end = line.data() + line.size();
    const char* at = skip_blanks(line.data(), end);
    std::uint64_t words = 0;
    for (char separator = ' '; at != end && separator != 0; ++words) {
      double value = 0;
      if (words == words_of_point_ || !parse_number(at, end, value)) break;
      for (int axis = 0; axis < 3; ++axis) {
        if (words_[static_cast<std::size_t>(axis)] == words) point[axis] = value;
      }
      separator = skip_separator(at, end);
      if (at == end && separator != ' ' && separator != 0) break;
    }
    if (at != end || words != words_of_point_) {
      fail(excerpt(line) + "; expected " + std::to_string(words_of_point_) +
           " numbers, as FIELDS and COUNT declare");
    }
  }

  std::uint64_t words_of_point_ = 0;
  std::array<std::uint64_t, 3> words_{};  // indices of the words x, y and z in a line
  OpenEnd open_end_;
};

}  // namespace

std::unique_ptr<PointReader> read_ascii_pcd(InputBuffer input, PcdHeader header) {
  return std::make_unique<AsciiPcdReader>(std::move(input), std::move(header));
}

}  // namespace clearway
