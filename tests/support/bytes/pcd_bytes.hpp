#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

namespace clearway::test {

/// The header of a PCD file; each member holds what stands behind its keyword.
struct PcdHeaderText {
  std::string fields = "x y z";
  std::string size = "4 4 4";
  std::string type = "F F F";
  std::string count = "1 1 1";
  std::string width = "2";
  std::string height = "1";
  std::string viewpoint = "0 0 0 1 0 0 0";
  std::string points = "2";

  std::string build(const std::string& data) const {
    return "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS " + fields + "\nSIZE " +
           size + "\nTYPE " + type + "\nCOUNT " + count + "\nWIDTH " + width + "\nHEIGHT " +
           height + "\nVIEWPOINT " + viewpoint + "\nPOINTS " + points + "\nDATA " + data + "\n";
  }
};

/// The bytes of numbers as they lie in memory.
template <typename... Numbers>
std::string raw(Numbers... numbers) {
  std::string bytes;
  const auto add = [&bytes](auto number) {
    char at[sizeof number];
    std::memcpy(at, &number, sizeof number);
    bytes.append(at, sizeof number);
  };
  (add(numbers), ...);
  return bytes;
}

/// Compresses with LZF, greedily, with matches of 3 to 264 bytes up to 8192 bytes back.
inline std::string lzf(std::string_view text) {
  std::string out, literals;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literals.size(); at += 32) {
      const std::string_view run = std::string_view(literals).substr(at, 32);
      out += static_cast<char>(run.size() - 1);
      out += run;
    }
    literals.clear();
  };
  std::map<std::string, std::size_t, std::less<>> seen;
  for (std::size_t at = 0; at < text.size();) {
    const auto key = text.substr(at, 3);
    const auto found = seen.find(key);
    std::size_t length = 0, distance = 0;
    if (key.size() == 3 && found != seen.end() && at - found->second <= 8192) {
      distance = at - found->second;
      while (length < 264 && at + length < text.size() &&
             text[at + length] == text[at + length - distance]) {
        ++length;
      }
    }
    if (key.size() == 3) seen[std::string(key)] = at;
    if (length < 3) {
      literals += text[at++];
      continue;
    }
    flush();
    const std::size_t high = (distance - 1) >> 8;
    if (length - 2 < 7) {
      out += static_cast<char>((length - 2) << 5 | high);
    } else {
      out += static_cast<char>(7 << 5 | high);
      out += static_cast<char>(length - 2 - 7);
    }
    out += static_cast<char>((distance - 1) & 0xFF);
    at += length;
  }
  flush();
  return out;
}

/// The bytes behind the line "DATA binary_compressed": both sizes and the compressed columns.
inline std::string compressed(std::string_view columns) {
  const std::string packed = lzf(columns);
  return raw(static_cast<std::uint32_t>(packed.size()),
             static_cast<std::uint32_t>(columns.size())) +
         packed;
}

}  // namespace clearway::test
