#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace clearway {

/// An XML text of a file, parsed within limits. Its functions throw only InputError, with the place
/// in the file. pugixml skips a document type definition and expands no entity that one declares,
/// so a small text cannot grow. It does not recurse, so deep nesting is harmless.
class XmlText {
 public:
  /// Turns an offset in the text into a place in the file, such as "line 7".
  using Place = std::function<std::string(std::uint64_t offset)>;
  XmlText(const XmlText&) = delete;
  XmlText& operator=(const XmlText&) = delete;

  const std::string& name() const { return name_; }  ///< the file's
  pugi::xml_node root() const { return root_; }

  [[noreturn]] void refuse_at(pugi::xml_node node, const std::string& what) const;

  /// The text of an element, without that of its children.
  std::string text(pugi::xml_node node) const;

  /// An attribute as text or number; nullopt where it is missing.
  std::optional<std::string_view> attribute(pugi::xml_node node, const char* name) const;
  template <typename Number>
  std::optional<Number> number_attribute(pugi::xml_node node, const char* name) const;

 protected:
  /// Parses nothing yet. name: that of the file. what: names the text in messages, such as "the XML
  /// section". place: called only for messages.
  XmlText(std::string name, std::string what, Place place);

  /// Parses the text, which is in UTF-8 and has a root element of this name. Elements in the
  /// namespace of the root are known by their names without a prefix afterwards. most_markup:
  /// greatest number of tags and attributes together; pugixml keeps up to 64 bytes for each.
  void parse(std::vector<char> text, std::uint64_t most_markup, const char* root);
  [[noreturn]] void refuse_offset(std::uint64_t offset, const std::string& what) const;
  pugi::xml_node first_node() const { return document_.first_child(); }

 private:
  void drop_prefixes();

  std::string name_, what_;
  Place place_;
  std::vector<char> bytes_;
  pugi::xml_document document_;
  pugi::xml_node root_;
};

extern template std::optional<double> XmlText::number_attribute(pugi::xml_node, const char*) const;
extern template std::optional<std::int64_t> XmlText::number_attribute(pugi::xml_node,
                                                                      const char*) const;
extern template std::optional<std::uint64_t> XmlText::number_attribute(pugi::xml_node,
                                                                       const char*) const;

/// The text without the blanks and line breaks around it.
std::string_view without_space_around(std::string_view text);

/// Parses the whole text as a number, where a leading + is allowed. NaN and infinity are numbers
/// here; one that is too large for its type is none.
template <typename Number>
std::optional<Number> whole_number_of(std::string_view text);
extern template std::optional<double> whole_number_of(std::string_view);

}  // namespace clearway
