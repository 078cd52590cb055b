#include "io/files/xml_text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <map>
#include <type_traits>
#include <utility>

#include "io/files/input_error.hpp"

namespace clearway {

std::string_view without_space_around(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

template <typename Number>
std::optional<Number> whole_number_of(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  Number value{};
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>) {
    // A number too small for a double becomes 0; one too large is refused.
    if (error == std::errc::result_out_of_range) {
      value = std::strtod(std::string(text).c_str(), nullptr);
      return std::isfinite(value) ? std::optional(value) : std::nullopt;
    }
  }
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

template std::optional<double> whole_number_of(std::string_view);

XmlText::XmlText(std::string name, std::string what, Place place)
    : name_(std::move(name)), what_(std::move(what)), place_(std::move(place)) {}

void XmlText::refuse_offset(std::uint64_t offset, const std::string& what) const {
  refuse(name_, place_(offset) + ": " + what);
}

void XmlText::refuse_at(pugi::xml_node node, const std::string& what) const {
  const auto offset = static_cast<std::uint64_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
  refuse_offset(offset, "XML element " + excerpt(node.name()) + ": " + what);
}

namespace {

/// The element after this one in the order of the text; empty after the last one.
pugi::xml_node next_element(pugi::xml_node node) {
  const auto is_element = [](pugi::xml_node n) { return n.type() == pugi::node_element; };
  pugi::xml_node next = node.find_child(is_element);
  for (; !next && node; node = node.parent()) {
    for (next = node.next_sibling(); next && !is_element(next);) next = next.next_sibling();
    if (next) break;
  }
  return next;
}

/// The prefix of a qualified name, "lx" of "lx:LandXML"; empty where it has none.
std::string_view prefix_of(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == std::string_view::npos ? std::string_view() : name.substr(0, colon);
}

}  // namespace

/// Removes from the names of elements the prefixes that stand for the root's namespace. Throws
/// where such a prefix stands for another namespace elsewhere.
void XmlText::drop_prefixes() {
  constexpr std::string_view kDeclares = "xmlns:";
  const pugi::xml_node root = document_.document_element();
  const std::string own(prefix_of(root.name()));
  const std::string uri =
      root.attribute(own.empty() ? "xmlns" : (std::string(kDeclares) + own).c_str()).value();
  std::map<std::string, bool, std::less<>> is_own;
  if (!own.empty()) is_own[own] = true;
  for (pugi::xml_node node = root; node; node = next_element(node)) {
    for (const pugi::xml_attribute declared : node.attributes()) {
      std::string_view name = declared.name();
      if (!name.starts_with(kDeclares)) continue;
      name.remove_prefix(kDeclares.size());
      const bool same = !uri.empty() && declared.value() == uri;
      const auto [found, added] = is_own.emplace(name, same);
      if (!added && found->second != same) {
        refuse_at(node, "declares the prefix " + excerpt(name) +
                            " for another namespace than elsewhere; expected one namespace each");
      }
    }
  }
  for (pugi::xml_node node = root; node; node = next_element(node)) {
    const std::string_view name = node.name();
    const std::string_view prefix = prefix_of(name);
    if (prefix.empty()) continue;
    const auto found = is_own.find(prefix);
    if (found == is_own.end() || !found->second) continue;
    // Copied, because pugixml writes the new name in the place of the old one.
    node.set_name(std::string(name.substr(prefix.size() + 1)).c_str());
  }
}

void XmlText::parse(std::vector<char> text, std::uint64_t most_markup, const char* root) {
  bytes_ = std::move(text);
  const auto markup = static_cast<std::uint64_t>(
      std::count_if(bytes_.begin(), bytes_.end(), [](char c) { return c == '<' || c == '='; }));
  if (markup > most_markup) {
    refuse_offset(0, what_ + " has " + std::to_string(markup) +
                         " tags and attributes; expected at most " + std::to_string(most_markup));
  }
  const auto parsed = document_.load_buffer_inplace(bytes_.data(), bytes_.size(),
                                                    pugi::parse_default | pugi::parse_declaration,
                                                    pugi::encoding_utf8);
  if (!parsed) {
    refuse_offset(
        static_cast<std::uint64_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)),
        what_ + " is malformed (" + parsed.description() + "); expected well-formed XML in UTF-8");
  }
  drop_prefixes();
  root_ = document_.document_element();
  if (std::string_view(root_.name()) != root) {
    refuse_offset(0, what_ + " holds the element " + excerpt(root_.name()) + "; expected " + root);
  }
}

std::string XmlText::text(pugi::xml_node node) const {
  std::string all;
  for (const pugi::xml_node part : node.children()) {
    if (part.type() == pugi::node_pcdata || part.type() == pugi::node_cdata) all += part.value();
  }
  return all;
}

std::optional<std::string_view> XmlText::attribute(pugi::xml_node node, const char* name) const {
  const pugi::xml_attribute found = node.attribute(name);
  if (!found) return std::nullopt;
  for (pugi::xml_attribute next = found.next_attribute(); next; next = next.next_attribute()) {
    if (std::string_view(next.name()) == name) {
      refuse_at(node, "has the attribute " + std::string(name) + " twice; expected it once");
    }
  }
  return found.value();
}

template <typename Number>
std::optional<Number> XmlText::number_attribute(pugi::xml_node node, const char* name) const {
  const auto text = attribute(node, name);
  if (!text) return std::nullopt;
  const auto value = whole_number_of<Number>(without_space_around(*text));
  if (!value) {
    refuse_at(node, "has " + std::string(name) + "=" + excerpt(*text) + "; expected a number" +
                        (std::is_floating_point_v<Number> ? "" : " without fraction that fits"));
  }
  return value;
}

template std::optional<double> XmlText::number_attribute(pugi::xml_node, const char*) const;
template std::optional<std::int64_t> XmlText::number_attribute(pugi::xml_node, const char*) const;
template std::optional<std::uint64_t> XmlText::number_attribute(pugi::xml_node, const char*) const;

}  // namespace clearway
