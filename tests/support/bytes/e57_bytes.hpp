#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace clearway::test {

/// Builds E57 files byte by byte, straight from the standard and without the reader's code.
struct E57Bytes {
  static constexpr std::size_t kHeaderBytes = 48;

  /// One field of the points: its XML element, and the bits stored for each record.
  struct Field {
    std::string xml;
    unsigned bits = 0;
    std::vector<std::uint64_t> stored;

    /// The stored bits, least significant first, with the last byte filled up with zeros.
    std::string bytestream() const {
      std::string bytes((stored.size() * bits + 7) / 8, '\0');
      for (std::size_t bit = 0; bit < stored.size() * bits; ++bit) {
        if ((stored[bit / bits] >> (bit % bits) & 1) != 0) {
          bytes[bit / 8] = static_cast<char>(bytes[bit / 8] | 1 << (bit % 8));
        }
      }
      return bytes;
    }
  };

  struct Scan {
    std::vector<Field> fields;
    std::string xml;  ///< the scan's elements beside its points: pose, bounds
    /// Bytes of each bytestream in each packet; what is left goes into the last one.
    std::vector<std::vector<std::size_t>> packets = {};
    bool index_packets = false;  ///< whether index and ignored packets precede data packets
    std::string padding;  ///< bytes behind the first bytestream's end, as some writers fill words

    std::size_t records() const { return fields.empty() ? 0 : fields[0].stored.size(); }
  };

  /// The content of a file without checksums, and where its sections and its XML begin.
  struct Content {
    std::string bytes;
    std::vector<std::uint64_t> sections;
    std::uint64_t xml = 0;
  };

  std::vector<Scan> scans;
  std::string root_xml;  ///< elements of e57Root beside data3D
  std::string declaration = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  std::size_t page = 1024;

  static Field float64(const std::string& name, const std::vector<double>& values) {
    Field field{"<" + name + " type=\"Float\"/>", 64, {}};
    for (const double value : values) field.stored.push_back(std::bit_cast<std::uint64_t>(value));
    return field;
  }
  static Field float32(const std::string& name, const std::vector<float>& values) {
    Field field{"<" + name + " type=\"Float\" precision=\"single\"/>", 32, {}};
    for (const float value : values) field.stored.push_back(std::bit_cast<std::uint32_t>(value));
    return field;
  }
  /// A field of integers. more: the further attributes, scale and offset, of a ScaledInteger.
  static Field integer(const std::string& name, std::int64_t minimum, std::int64_t maximum,
                       const std::vector<std::int64_t>& values, const std::string& more = "") {
    const std::uint64_t range =
        static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum);
    Field field{"<" + name + " type=\"" + (more.empty() ? "Integer" : "ScaledInteger") +
                    "\" minimum=\"" + std::to_string(minimum) + "\" maximum=\"" +
                    std::to_string(maximum) + "\" " + more + "/>",
                static_cast<unsigned>(std::bit_width(range)),
                {}};
    for (const std::int64_t value : values) {
      field.stored.push_back(static_cast<std::uint64_t>(value) -
                             static_cast<std::uint64_t>(minimum));
    }
    return field;
  }
  static std::string number(const std::string& name, const std::string& value) {
    return "<" + name + " type=\"Float\">" + value + "</" + name + ">";
  }
  /// The pose element. rotation and translation: texts of numbers, in the order w x y z and x y z.
  static std::string pose(const std::vector<std::string>& rotation,
                          const std::vector<std::string>& translation) {
    constexpr const char* kNames[] = {"w", "x", "y", "z"};
    std::string xml = "<pose type=\"Structure\"><rotation type=\"Structure\">";
    for (std::size_t k = 0; k < 4; ++k) xml += number(kNames[k], rotation[k]);
    xml += "</rotation><translation type=\"Structure\">";
    for (std::size_t k = 0; k < 3; ++k) xml += number(kNames[k + 1], translation[k]);
    return xml + "</translation></pose>";
  }

  template <typename Number>
  static void put(std::string& bytes, std::size_t at, Number value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }
  template <typename Number>
  static void append(std::string& bytes, Number value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  std::uint64_t physical(std::uint64_t logical) const {
    return logical / (page - 4) * page + logical % (page - 4);
  }

  /// CRC-32C, computed bit by bit.
  static std::uint32_t checksum(const char* bytes, std::size_t count) {
    std::uint32_t remainder = 0xFFFFFFFF;
    for (std::size_t i = 0; i < count; ++i) {
      remainder ^= static_cast<unsigned char>(bytes[i]);
      for (int bit = 0; bit < 8; ++bit) {
        remainder = (remainder >> 1) ^ ((remainder & 1) != 0 ? 0x82F63B78U : 0U);
      }
    }
    return ~remainder;
  }
  /// Corrects the checksum of every whole page.
  static void repair(std::string& file, std::size_t page = 1024) {
    for (std::size_t start = 0; start + page <= file.size(); start += page) {
      const std::uint32_t sum = checksum(file.data() + start, page - 4);
      for (unsigned i = 0; i < 4; ++i) {
        file[start + page - 4 + i] = static_cast<char>(sum >> (24 - 8 * i) & 0xFF);
      }
    }
  }
  /// The file of a content: pages with checksums, and the file's size in its header.
  static std::string paged(const std::string& content, std::size_t page = 1024) {
    std::string file;
    for (std::size_t at = 0; at < content.size(); at += page - 4) {
      std::string one = content.substr(at, page - 4);
      one.resize(page, '\0');
      file += one;
    }
    if (file.size() >= 24) put<std::uint64_t>(file, 16, file.size());
    repair(file, page);
    return file;
  }

  Content content() const {
    Content result;
    std::string& bytes = result.bytes;
    bytes = std::string("ASTM-E57\1\0\0\0\0\0\0\0", 16) + std::string(32, '\0');
    put<std::uint64_t>(bytes, 40, page);
    std::string xml = declaration + "<e57Root type=\"Structure\" xmlns=\"http://www.astm.org/" +
                      "COMMIT/E57/2010-e57-v1.0\">\n" + root_xml +
                      "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n";
    for (const Scan& scan : scans) {
      result.sections.push_back(bytes.size());
      append_section(bytes, scan);
      xml += "<vectorChild type=\"Structure\">" + scan.xml +
             "<points type=\"CompressedVector\" fileOffset=\"" +
             std::to_string(physical(result.sections.back())) + "\" recordCount=\"" +
             std::to_string(scan.records()) + "\"><prototype type=\"Structure\">";
      for (const Field& field : scan.fields) xml += field.xml;
      xml += "</prototype><codecs type=\"Vector\"></codecs></points></vectorChild>\n";
    }
    xml += "</data3D></e57Root>\n";
    result.xml = bytes.size();
    put<std::uint64_t>(bytes, 24, physical(result.xml));
    put<std::uint64_t>(bytes, 32, xml.size());
    bytes += xml;
    return result;
  }

  std::string build() const { return paged(content().bytes, page); }

 private:
  static void append_data_packet(std::string& bytes, const std::vector<std::string>& streams) {
    std::string packet("\1\0\0\0", 4);
    append(packet, static_cast<std::uint16_t>(streams.size()));
    for (const std::string& part : streams) append(packet, static_cast<std::uint16_t>(part.size()));
    for (const std::string& part : streams) packet += part;
    packet.resize((packet.size() + 3) / 4 * 4, '\0');
    put(packet, 2, static_cast<std::uint16_t>(packet.size() - 1));
    bytes += packet;
  }

  void append_section(std::string& bytes, const Scan& scan) const {
    const std::size_t start = bytes.size();
    bytes += std::string(32, '\0');
    std::vector<std::string> left;
    for (const Field& field : scan.fields) left.push_back(field.bytestream());
    if (!left.empty()) left[0] += scan.padding;
    auto packets = scan.packets;
    packets.emplace_back(scan.fields.size(), std::string::npos);
    for (const auto& sizes : packets) {
      if (scan.index_packets) {
        bytes += std::string("\0\0\x0F\0\0\0\0\0\0\0\0\0\0\0\0\0", 16);
        bytes += std::string("\2\0\3\0", 4);
      }
      std::vector<std::string> parts;
      for (std::size_t i = 0; i < left.size(); ++i) {
        parts.push_back(left[i].substr(0, sizes[i]));
        left[i].erase(0, sizes[i]);
      }
      append_data_packet(bytes, parts);
    }
    bytes[start] = 1;
    put<std::uint64_t>(bytes, start + 8, bytes.size() - start);
    put(bytes, start + 16, physical(start + 32));
  }
};

/// A scan of Cartesian coordinates in double.
inline E57Bytes::Scan e57_scan(const std::vector<double>& x, const std::vector<double>& y,
                               const std::vector<double>& z) {
  E57Bytes::Scan scan;
  scan.fields = {E57Bytes::float64("cartesianX", x), E57Bytes::float64("cartesianY", y),
                 E57Bytes::float64("cartesianZ", z)};
  return scan;
}

}  // namespace clearway::test
