#pragma once

#include <complex>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "clearway/alignment.hpp"
#include "core/util/format.hpp"
#include "io/files/xml_text.hpp"
#include "io/scans/formatted_message.hpp"

namespace clearway {

/// A value of an attribute by its name.
template <typename Value>
using NamedValue = std::pair<std::string_view, Value>;

/// A LandXML file, which names places by their line. Lengths are given in metres.
class LandXml : public XmlText {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;
  static constexpr std::uint64_t kMostMarkup = std::uint64_t{1} << 23;

  /// Reads and parses the file. order: of its coordinates. Throws InputError and ResourceError.
  LandXml(const std::filesystem::path& path, AxisOrder order);

  using XmlText::refuse_at;
  template <typename... Args>
  [[noreturn]] void refuse_at(pugi::xml_node node, fmt::format_string<const Args&...> what,
                              const Args&... args) const {
    refuse_at(node, fmt::format(what, args...));
  }

  /// Refuses the value of an attribute: "has NAME=VALUE; expected ...".
  [[noreturn]] void refuse_value(pugi::xml_node node, const char* name,
                                 const std::string& expected) const {
    refuse_at(node, "has {}={}; expected {}", name, excerpt(*attribute(node, name)), expected);
  }

  double metres_per_unit() const { return metres_; }
  /// The unit's name in LandXML, such as "USSurveyFoot".
  const std::string& unit_name() const { return unit_name_; }
  bool is_imperial() const { return imperial_; }
  /// A length or station of the file in metres, and back in the unit of the file.
  double in_metres(double length) const { return UnitFactor(metres_)(length); }
  double in_units(double metres) const { return metres / metres_; }
  /// A length or station in the unit of the file, for messages.
  std::string unit_text(double metres) const { return format_digits(in_units(metres), 9); }
  /// What to do where the coordinates seem to be swapped.
  std::string swapped_advice() const;

  /// The only child of that name; an empty node where there is none. Throws where there are two.
  /// otherwise: another remedy than to have it once, for the message, such as ", or --cant none".
  pugi::xml_node only_child(pugi::xml_node parent, const char* name,
                            const char* otherwise = "") const;

  /// The attribute `name` of an element, in UTF-8; empty where it has none.
  std::string name_of(pugi::xml_node node) const;

  /// A finite number of an attribute; nullopt where it is missing.
  std::optional<double> number(pugi::xml_node node, const char* attribute) const;
  /// A finite length or station of an attribute in metres; nullopt where it is missing. Throws for
  /// one below `least`.
  std::optional<double> length(pugi::xml_node node, const char* attribute,
                               double least = -std::numeric_limits<double>::infinity()) const;
  /// A value that the caller requires. Throws where it is missing. what: says what it is, for the
  /// message.
  template <typename Value>
  Value required(const std::optional<Value>& value, pugi::xml_node node, const char* attribute,
                 const std::string& what) const {
    if (!value) refuse_at(node, "has no attribute {}; expected {}", attribute, what);
    return *value;
  }

  /// The value that an attribute names. missing: what stands for it where there is none; nullopt
  /// where it is required. otherwise: the end of the message about any other name.
  template <typename Value, std::size_t kCount>
  Value named(pugi::xml_node node, const char* attribute_name,
              const NamedValue<Value> (&known)[kCount], std::optional<Value> missing = std::nullopt,
              const std::string& otherwise = "") const {
    const auto text = attribute(node, attribute_name);
    if (!text && missing) return *missing;
    std::string list;
    for (const auto& [name, value] : known) {
      if (text && without_space_around(*text) == name) return value;
      const bool last = &value == &known[kCount - 1].second;
      list += (list.empty() ? "" : last ? " or " : ", ") + std::string(name);
    }
    required(text, node, attribute_name, list + otherwise);
    refuse_value(node, attribute_name, list + otherwise);
  }

  /// The finite numbers of an element's text. Throws where there are fewer than `least` or more
  /// than `most`. what: what they are, such as "a northing and an easting".
  std::vector<double> numbers(pugi::xml_node node, std::size_t least, std::size_t most,
                              const char* what) const;
  /// The place of the only child of that name: easting + i northing in metres. Throws where it
  /// stands twice or refers to a point that stands elsewhere.
  std::optional<std::complex<double>> find_place(pugi::xml_node parent, const char* name) const;
  /// The place that find_place() finds. Throws also where it is missing.
  std::complex<double> place(pugi::xml_node parent, const char* name) const;

 private:
  void read_unit();

  AxisOrder order_;
  double metres_ = 1;
  std::string unit_name_;
  bool imperial_ = false;
};

}  // namespace clearway
