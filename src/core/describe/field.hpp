#pragma once

#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

/// What a field of a public struct is, said once, in a list of this folder, for everything that
/// shows, reads or keeps it. From an entry are made
/// - options and their help (tools/cli/support/field_options.hpp), and from the help the tables of
///   the guide, manual pages and completion (tools/option_tables.py, man_pages.py, completion.py),
/// - keys of campaigns (src/campaign/campaign_file.cpp) and checks of a query (check_query.cpp),
/// - facts of results (src/io/result), their comparison, and the identity of a journal,
/// - JSON (src/io/files/facts_json.hpp), the files of findings (conflict_fields.hpp) with their
///   tables in the guide, and the facts of pages (src/report/report_facts.cpp),
/// - properties, arguments, docstrings and the stub of Python (src/python/binding.hpp).
/// An option that sets several members or reads another file, and which options exclude each other,
/// is code.
namespace clearway {

/// The groups of options in a help text, in the order in which it shows them.
enum class OptionGroup {
  kInputs,
  kQuestion,
  kCertainty,
  kIgnored,
  kCorridor,
  kStore,
  kModel,
  kPath,
  kUnits,
  kConflicts,
  kPage,
  kSection,
  kSpeed,
  kFiles,
  kOutput
};

/// What a number of a field counts.
enum class FieldUnit { kMetres, kRadians, kSeconds, kBytes, kNone };

/// The symbol of a unit, such as "m"; empty for bytes and for what has no unit.
constexpr std::string_view symbol_of(FieldUnit unit) {
  switch (unit) {
    case FieldUnit::kMetres:
      return "m";
    case FieldUnit::kRadians:
      return "rad";
    case FieldUnit::kSeconds:
      return "s";
    default:
      return "";
  }
}

/// The finite numbers that a field accepts.
enum class FieldRange { kAny, kFromZero, kAboveZero };

/// A member of a public struct, with all names and texts of it. Its default is that of the struct.
/// A property that a consumer needs stands here as data, and is never guessed from the type, the
/// name or the member.
template <typename Struct, typename Type>
struct Field {
  using Owner = Struct;
  using Value = Type;

  Type Struct::*member;
  const char* key;  ///< name in results, JSON and Python, and in campaigns unless below
  const char* campaign_key = "";               ///< name in campaigns, if it is another one
  const char* topic = "";                      ///< name in messages, as in "the radius"
  const char* option = "";                     ///< option of the command line; empty: it has none
  OptionGroup group = OptionGroup::kQuestion;  ///< where the help shows the option
  const char* value_name = "";  ///< the help's name for its value, if the type does not say it
  const char* help = "";        ///< help text of the option, without its default
  const char* usual = "";  ///< what the help gives as the default; empty: it says nothing of it
  const char* doc = "";    ///< documentation in Python
  const char* yes = "asked for";     ///< a flag that is set, where questions are compared
  const char* no = "not asked for";  ///< a flag or length that is not set, where they are compared
  FieldUnit unit = FieldUnit::kMetres;        ///< what a number counts
  FieldRange range = FieldRange::kAboveZero;  ///< the numbers that the option accepts
  double least = 0, most = 0;  ///< the range of a whole number or of seconds; 0, 0: any
  bool is_required = false;    ///< whether every question has to give it
  bool is_of_budget = false;   ///< whether only a query with an error budget may change the default
  /// Whether a result keeps the default by having no attribute of this name.
  bool is_kept_if_set = false;
  bool is_always_listed = false;  ///< whether lists of a question name it also where not set
  /// Whether it comes from campaign.json, and not from the campaign itself.
  bool is_in_campaigns = true;

  const Type& of(const Struct& owner) const { return owner.*member; }
  Type& of(Struct& owner) const { return owner.*member; }
  bool is_default(const Struct& owner) const { return of(owner) == of(Struct{}); }
  const char* name_in_campaigns() const { return *campaign_key == '\0' ? key : campaign_key; }
  std::string help_with_default() const {
    return *usual == '\0' ? help : std::string(help) + " (default: " + usual + ")";
  }
};

/// Calls visit(field) for each field of a list, in its order.
template <typename... Fields, typename Visit>
void for_each_field(const std::tuple<Fields...>& fields, const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, fields);
}

/// A value of an enumeration and its name for users.
template <typename Enum>
struct Choice {
  const char* name;
  Enum value;
};

/// The values of an enumeration that users may choose, specialised beside the list of its fields.
template <typename Enum>
inline constexpr int kChoices = 0;

}  // namespace clearway
