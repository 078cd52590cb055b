#pragma once

#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/formats/e57/e57_header.hpp"

namespace clearway {

/// The XML section of an E57 file. Its functions throw only InputError, with the byte in the file.
/// pugixml skips a document type definition and expands no entity that one declares, so a small
/// section cannot grow. It does not recurse, so deep nesting is harmless.
class E57Xml {
 public:
  static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 26;
  /// Greatest number of tags and attributes together; pugixml keeps up to 64 bytes for each.
  static constexpr std::uint64_t kMostMarkup = std::uint64_t{1} << 21;

  explicit E57Xml(E57Container& file);

  /// The element e57Root.
  pugi::xml_node root() const { return root_; }

  [[noreturn]] void refuse_at(pugi::xml_node node, const std::string& what) const;

  /// The child of that name, or an empty node. Throws for a second child of the name and for
  /// another E57 type.
  pugi::xml_node find(pugi::xml_node parent, const char* name, std::string_view type) const;
  /// The child of that name. Throws for a missing or second child of the name and for another E57
  /// type.
  pugi::xml_node get(pugi::xml_node parent, const char* name, std::string_view type) const;
  std::string_view type_of(pugi::xml_node node) const;

  /// The number in an element of type Float or Integer; 0 where the element is empty, as E57
  /// defines.
  double number(pugi::xml_node node) const;
  std::string text(pugi::xml_node node) const;

  /// An attribute as text or number; nullopt where it is missing.
  std::optional<std::string_view> attribute(pugi::xml_node node, const char* name) const;
  template <typename Number>
  std::optional<Number> number_attribute(pugi::xml_node node, const char* name) const;

 private:
  void parse();
  void check_declaration() const;
  std::uint64_t byte_of(pugi::xml_node node) const;
  [[noreturn]] void refuse_missing(pugi::xml_node parent, const char* name,
                                   std::string_view type) const;

  const E57Pages& pages_;
  std::uint64_t start_;  ///< logical position of the section
  std::vector<char> bytes_;
  pugi::xml_document document_;
  pugi::xml_node root_;
};

extern template std::optional<double> E57Xml::number_attribute(pugi::xml_node, const char*) const;
extern template std::optional<std::int64_t> E57Xml::number_attribute(pugi::xml_node,
                                                                     const char*) const;
extern template std::optional<std::uint64_t> E57Xml::number_attribute(pugi::xml_node,
                                                                      const char*) const;

}  // namespace clearway
