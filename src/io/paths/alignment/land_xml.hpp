#pragma once

#include <complex>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/xml_text.hpp"

namespace clearway {

/// A LandXML file, which names places by their line. Lengths are given in metres.
class LandXml : public XmlText {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
  static constexpr std::uint64_t kMostMarkup = std::uint64_t{1} << 23;

  /// Reads and parses the file. Throws InputError and ResourceError.
  explicit LandXml(const std::filesystem::path& path);

  double metres_per_unit() const { return metres_; }
  /// The unit's name in LandXML, such as "USSurveyFoot".
  const std::string& unit_name() const { return unit_name_; }
  bool is_imperial() const { return imperial_; }

  /// The only child of that name; an empty node where there is none. Throws where there are two.
  /// otherwise: another remedy than to have it once, for the message, such as ", or --cant none".
  pugi::xml_node only_child(pugi::xml_node parent, const char* name,
                            const char* otherwise = "") const;

  /// The attribute `name` of an element, in UTF-8; empty where it has none.
  std::string name_of(pugi::xml_node node) const;

  /// A finite number of an attribute; nullopt where it is missing.
  std::optional<double> number(pugi::xml_node node, const char* attribute) const;
  /// A finite length or station of an attribute in metres; nullopt where it is missing.
  std::optional<double> length(pugi::xml_node node, const char* attribute) const;
  /// The same; throws where it is missing. what: says what it is, for the message.
  double required_length(pugi::xml_node node, const char* attribute, const char* what) const;

  /// The finite numbers of an element's text. Throws where there are fewer than `least` or more
  /// than `most`. what: what they are, such as "a northing and an easting".
  std::vector<double> numbers(pugi::xml_node node, std::size_t least, std::size_t most,
                              const char* what) const;
  /// The two coordinates of the only child of that name, in metres and in the file's order. Throws
  /// where it is missing, stands twice or refers to a point that stands elsewhere.
  std::optional<std::complex<double>> find_point(pugi::xml_node parent, const char* name) const;
  std::complex<double> point(pugi::xml_node parent, const char* name) const;

 private:
  void read_unit();
  void check_heights(pugi::xml_node system) const;

  double metres_ = 1;
  std::string unit_name_;
  bool imperial_ = false;
};

/// The name of an element.
inline std::string_view kind_of(pugi::xml_node node) { return node.name(); }

}  // namespace clearway
