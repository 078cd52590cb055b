#include "io/formats/e57/e57_xml.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "io/system/input_error.hpp"

namespace clearway {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Parses the whole text as a number; a leading + is allowed.
template <typename Number>
bool parse_whole(std::string_view text, Number& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end) return false;
  if constexpr (std::is_floating_point_v<Number>) {
    // A number too small for a double becomes 0; one too large is refused.
    if (error == std::errc::result_out_of_range) {
      value = std::strtod(std::string(text).c_str(), nullptr);
      return std::isfinite(value);
    }
  }
  return error == std::errc();
}

bool is_utf8_name(std::string_view encoding) {
  constexpr std::string_view kName = "utf-8";
  return std::equal(encoding.begin(), encoding.end(), kName.begin(), kName.end(),
                    [](char a, char b) { return a == b || (a >= 'A' && a <= 'Z' && a + 32 == b); });
}

}  // namespace

E57Xml::E57Xml(E57Container& file) : pages_(file.pages), start_(file.xml_start) {
  if (file.xml_bytes > kMostBytes) {
    refuse_byte(pages_.name(), 32,
                "an XML section of " + std::to_string(file.xml_bytes) +
                    " bytes; expected at most " + std::to_string(kMostBytes));
  }
  if (file.xml_bytes > pages_.size() - start_) {
    refuse_byte(pages_.name(), 32,
                "an XML section of " + std::to_string(file.xml_bytes) +
                    " bytes; expected it to end before the file");
  }
  bytes_.resize(file.xml_bytes);
  file.pages.read(start_, std::as_writable_bytes(std::span(bytes_)), "the XML section");
  parse();
}

void E57Xml::parse() {
  const std::uint64_t first_byte = pages_.physical(start_);
  const auto markup = static_cast<std::uint64_t>(
      std::count_if(bytes_.begin(), bytes_.end(), [](char c) { return c == '<' || c == '='; }));
  if (markup > kMostMarkup) {
    refuse_byte(pages_.name(), first_byte,
                "the XML section has " + std::to_string(markup) +
                    " tags and attributes; expected at most " + std::to_string(kMostMarkup));
  }
  const auto parsed = document_.load_buffer_inplace(bytes_.data(), bytes_.size(),
                                                    pugi::parse_default | pugi::parse_declaration,
                                                    pugi::encoding_utf8);
  if (!parsed) {
    const auto offset = static_cast<std::uint64_t>(std::max<std::ptrdiff_t>(parsed.offset, 0));
    refuse_byte(pages_.name(), pages_.physical(start_ + offset),
                std::string("the XML section is malformed (") + parsed.description() +
                    "); expected well-formed XML in UTF-8");
  }
  check_declaration();
  root_ = document_.document_element();
  if (std::string_view(root_.name()) != "e57Root") {
    refuse_byte(
        pages_.name(), first_byte,
        "the XML section holds the element " + excerpt(root_.name()) + "; expected e57Root");
  }
  if (type_of(root_) != "Structure") refuse_at(root_, "expected the type Structure");
}

void E57Xml::check_declaration() const {
  const pugi::xml_node declaration = document_.first_child();
  if (declaration.type() != pugi::node_declaration) return;
  const pugi::xml_attribute encoding = declaration.attribute("encoding");
  if (!encoding || is_utf8_name(encoding.value())) return;
  refuse_byte(
      pages_.name(), pages_.physical(start_),
      "the XML section is in the encoding " + excerpt(encoding.value()) + "; expected UTF-8");
}

std::uint64_t E57Xml::byte_of(pugi::xml_node node) const {
  const auto offset = static_cast<std::uint64_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
  return pages_.physical(start_ + offset);
}

void E57Xml::refuse_at(pugi::xml_node node, const std::string& what) const {
  refuse_byte(pages_.name(), byte_of(node), "XML element " + excerpt(node.name()) + ": " + what);
}

std::string_view E57Xml::type_of(pugi::xml_node node) const {
  return attribute(node, "type").value_or("");
}

pugi::xml_node E57Xml::find(pugi::xml_node parent, const char* name, std::string_view type) const {
  const pugi::xml_node node = parent.child(name);
  if (!node) return node;
  if (const pugi::xml_node second = node.next_sibling(name)) {
    refuse_at(second, "stands twice; expected it once in its parent");
  }
  if (type_of(node) != type) {
    refuse_at(node, "has the type " + excerpt(type_of(node)) + "; expected " + std::string(type));
  }
  return node;
}

pugi::xml_node E57Xml::get(pugi::xml_node parent, const char* name, std::string_view type) const {
  const pugi::xml_node node = find(parent, name, type);
  if (!node) refuse_at(parent, "has no " + std::string(name) + "; expected one");
  return node;
}

double E57Xml::number(pugi::xml_node node) const {
  const std::string value = text(node);
  const std::string_view digits = trimmed(value);
  double result = 0;
  if (!digits.empty() && !parse_whole(digits, result)) {
    refuse_at(node, "is " + excerpt(digits) + "; expected a number");
  }
  return result;
}

std::string E57Xml::text(pugi::xml_node node) const {
  std::string all;
  for (const pugi::xml_node part : node.children()) {
    if (part.type() == pugi::node_pcdata || part.type() == pugi::node_cdata) all += part.value();
  }
  return all;
}

std::optional<std::string_view> E57Xml::attribute(pugi::xml_node node, const char* name) const {
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
std::optional<Number> E57Xml::number_attribute(pugi::xml_node node, const char* name) const {
  const auto text = attribute(node, name);
  if (!text) return std::nullopt;
  Number value{};
  if (!parse_whole(trimmed(*text), value)) {
    refuse_at(node, "has " + std::string(name) + "=" + excerpt(*text) + "; expected a number" +
                        (std::is_floating_point_v<Number> ? "" : " without fraction that fits"));
  }
  return value;
}

template std::optional<double> E57Xml::number_attribute(pugi::xml_node, const char*) const;
template std::optional<std::int64_t> E57Xml::number_attribute(pugi::xml_node, const char*) const;
template std::optional<std::uint64_t> E57Xml::number_attribute(pugi::xml_node, const char*) const;

}  // namespace clearway
