#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/result.hpp"
#include "clearway/vec3.hpp"
#include "core/seen/cross_sections.hpp"
#include "io/result/result_header.hpp"

/// The schema of a result's tables: for each table its columns, in the order of the file, with the
/// results that have them and what their values must be. Writer, reader, streams, merge, verify,
/// compare and exports take the columns from here, so a new column is a member of the rows and a
/// line of the schema.
namespace clearway {

/// The rows of a profile as a file keeps them.
struct ProfileRows : Profile {
  /// The squared distances whose roots are the distances; empty unless the file is a part.
  std::vector<double> squared = {};
};

/// Where rows were read, for the messages of their checks.
struct RowsRead {
  const std::string& name;  ///< name of the file
  const ResultHeader& header;
  const char* group;
  std::uint64_t first;  ///< the row of the group that the first value belongs to

  /// Throws InputError that names the row.
  [[noreturn]] void refuse_row(const char* dataset, std::size_t row,
                               const std::string& expected) const;
};

/// A column of a table whose rows are `Rows`.
template <typename Rows, typename T>
struct Column {
  using Value = T;

  const char* dataset;
  /// The values, one for each row; no values where the result does not have the column.
  std::vector<T> Rows::*values;
  bool (*is_in)(const ResultHeader& header);  ///< whether a result has the column
  /// Throws InputError for a value that no run can have written, whatever stands in other rows.
  /// Thread safe.
  void (*check)(const RowsRead& read, const char* dataset, std::span<const T> values);
  /// Describes the column in exported files, in up to 31 characters. Null for a column that is not
  /// exported as a field of its own.
  const char* field = nullptr;
};

// Checks of values that several columns share.
void check_sources(const RowsRead& read, const char* dataset, std::span<const std::uint64_t>);
void check_points(const RowsRead& read, const char* dataset, std::span<const Vec3>);
void check_poses(const RowsRead& read, const char* dataset, std::span<const std::uint32_t>);
void check_bodies(const RowsRead& read, const char* dataset, std::span<const std::uint32_t>);
void check_flags(const RowsRead& read, const char* dataset, std::span<const std::uint8_t>);
void check_clearances(const RowsRead& read, const char* dataset, std::span<const double>);
/// Lengths of the path, finite and 0 or more.
void check_steps(const RowsRead& read, const char* dataset, std::span<const double>);
/// Groups of unseen cubes: from 1 on, and 0 in parts.
void check_groups(const RowsRead& read, const char* dataset, std::span<const std::uint32_t>);
/// Cells of cross-sections along one of three axes.
void check_cells(const RowsRead& read, const char* dataset,
                 std::span<const std::array<std::int32_t, 3>>);
/// Parts of cubes, 1 or more.
void check_parts(const RowsRead& read, const char* dataset, std::span<const std::uint64_t>);
void check_chainages(const RowsRead& read, const char* dataset, std::span<const double>);
/// For values that only the check of whole rows can judge.
template <typename T>
void check_with_rows(const RowsRead&, const char*, std::span<const T>) {}

/// For columns that no result of their table lacks.
inline bool in_every_result(const ResultHeader&) { return true; }
/// For the classes of points.
inline bool has_classes(const ResultHeader& header) { return header.has_classes(); }

/// The order of tables of points: kOrder is the column by which rows ascend, and may_follow() says
/// whether a value may stand in the row after another.
template <typename Rows>
struct AscendingSources {
  static constexpr auto kOrder = &Rows::source;
  static constexpr const char* kOrderDataset = "source";
  static bool may_follow(std::uint64_t before, std::uint64_t after) { return after > before; }
  static constexpr const char* kExpectedOrder = "an index above the row before";
};

/// The schema of the table with these rows.
template <typename Rows>
struct Table;

template <>
struct Table<Collisions> : AscendingSources<Collisions> {
  using Rows = Collisions;
  static constexpr const char* kGroup = "collisions";
  static bool is_in(const ResultHeader&) { return true; }

  static constexpr std::tuple kColumns{
      Column<Rows, std::uint64_t>{"source", &Rows::source, in_every_result, check_sources},
      Column<Rows, Vec3>{"xyz", &Rows::xyz, in_every_result, check_points},
      Column<Rows, std::uint32_t>{"first_pose", &Rows::first_pose,
                                  [](const ResultHeader& h) { return h.first_pose; }, check_poses,
                                  "first pose that touches"},
      Column<Rows, std::uint32_t>{"body", &Rows::body,
                                  [](const ResultHeader& h) { return h.has_first_bodies(); },
                                  check_bodies, "body of that pose"},
      Column<Rows, std::uint32_t>{"last_pose", &Rows::last_pose,
                                  [](const ResultHeader& h) { return h.first_pose; }, check_poses},
      Column<Rows, std::uint8_t>{"certain", &Rows::certain,
                                 [](const ResultHeader& h) { return h.budget.has_value(); },
                                 check_flags},
      Column<Rows, double>{"depth", &Rows::depth, [](const ResultHeader& h) { return h.depth; },
                           check_with_rows<double>, "distance to nearest free point"},
      Column<Rows, std::uint64_t>{"depth_source", &Rows::depth_source,
                                  [](const ResultHeader& h) { return h.depth; },
                                  check_with_rows<std::uint64_t>, "index of that free point"},
      Column<Rows, std::uint8_t>{"class", &Rows::point_class, has_classes,
                                 check_with_rows<std::uint8_t>, "class of the point"}};

  /// Throws InputError where the columns of a row contradict each other.
  static void check(const RowsRead& read, const Rows& rows);
};

template <>
struct Table<Nearby> : AscendingSources<Nearby> {
  using Rows = Nearby;
  static constexpr const char* kGroup = "near";
  static bool is_in(const ResultHeader& header) { return header.budget.has_value(); }

  static constexpr std::tuple kColumns{
      Column<Rows, std::uint64_t>{"source", &Rows::source, in_every_result, check_sources},
      Column<Rows, Vec3>{"xyz", &Rows::xyz, in_every_result, check_points},
      Column<Rows, std::uint32_t>{"first_pose", &Rows::first_pose,
                                  [](const ResultHeader& h) { return h.first_pose; }, check_poses,
                                  "first pose that is near"},
      Column<Rows, std::uint32_t>{"body", &Rows::body,
                                  [](const ResultHeader& h) { return h.has_first_bodies(); },
                                  check_bodies, "body of that pose"},
      Column<Rows, std::uint8_t>{"class", &Rows::point_class, has_classes,
                                 check_with_rows<std::uint8_t>, "class of the point"}};
};

template <>
struct Table<Clearances> : AscendingSources<Clearances> {
  using Rows = Clearances;
  static constexpr const char* kGroup = "clearance";
  static bool is_in(const ResultHeader& header) { return header.clearance > 0; }

  static constexpr std::tuple kColumns{
      Column<Rows, std::uint64_t>{"source", &Rows::source, in_every_result, check_sources},
      Column<Rows, Vec3>{"xyz", &Rows::xyz, in_every_result, check_points},
      Column<Rows, double>{"distance", &Rows::distance, in_every_result, check_clearances,
                           "least distance to the model"},
      Column<Rows, std::uint32_t>{"pose", &Rows::pose, in_every_result, check_poses,
                                  "pose that has the distance"},
      Column<Rows, std::uint32_t>{"body", &Rows::body,
                                  [](const ResultHeader& h) { return !h.bodies.empty(); },
                                  check_bodies, "body of that pose"},
      Column<Rows, std::uint8_t>{"class", &Rows::point_class, has_classes,
                                 check_with_rows<std::uint8_t>, "class of the point"}};
};

template <>
struct Table<ProfileRows> {
  using Rows = ProfileRows;
  static constexpr const char* kGroup = "profile";
  static bool is_in(const ResultHeader& header) { return header.profile > 0; }

  static constexpr std::tuple kColumns{
      Column<Rows, double>{"distance", &Rows::distance, in_every_result, check_with_rows<double>},
      Column<Rows, std::uint64_t>{"source", &Rows::source, in_every_result,
                                  check_with_rows<std::uint64_t>},
      Column<Rows, Vec3>{"xyz", &Rows::xyz, in_every_result, check_with_rows<Vec3>},
      Column<Rows, double>{"chainage", &Rows::chainage, in_every_result, check_chainages},
      Column<Rows, double>{"squared", &Rows::squared,
                           [](const ResultHeader& h) { return h.part.has_value(); },
                           check_with_rows<double>},
      Column<Rows, std::uint8_t>{"class", &Rows::point_class, has_classes,
                                 check_with_rows<std::uint8_t>}};

  // The order, as in AscendingSources, but several poses may be at the same place.
  static constexpr auto kOrder = &Rows::chainage;
  static constexpr const char* kOrderDataset = "chainage";
  static bool may_follow(double before, double after) { return after >= before; }
  static constexpr const char* kExpectedOrder = "metres, not below the row before";

  /// Throws InputError unless distance, source and point of each pose agree. A pose without a point
  /// has infinity, Profile::kNoPoint and NaN.
  static void check(const RowsRead& read, const Rows& rows);
};

template <>
struct Table<UnseenCubes> {
  using Rows = UnseenCubes;
  static constexpr const char* kGroup = "unseen";
  static bool is_in(const ResultHeader& header) { return header.seen; }

  static constexpr std::tuple kColumns{
      Column<Rows, std::array<std::int32_t, 3>>{"cube", &Rows::cube, in_every_result,
                                                check_with_rows<std::array<std::int32_t, 3>>},
      Column<Rows, std::uint32_t>{"first_pose", &Rows::first_pose, in_every_result, check_poses},
      Column<Rows, std::uint32_t>{"group", &Rows::group, in_every_result, check_groups},
      Column<Rows, double>{"chainage", &Rows::chainage,
                           [](const ResultHeader& h) { return h.part.has_value(); }, check_steps},
      Column<Rows, double>{"step", &Rows::step,
                           [](const ResultHeader& h) { return h.part.has_value(); }, check_steps}};

  static constexpr auto kOrder = &Rows::cube;
  static constexpr const char* kOrderDataset = "cube";
  static bool may_follow(const std::array<std::int32_t, 3>& before,
                         const std::array<std::int32_t, 3>& after) {
    return before < after;
  }
  static constexpr const char* kExpectedOrder = "a cube after the one of the row before";
};

template <>
struct Table<SweptCells> {
  using Rows = SweptCells;
  static constexpr const char* kGroup = "swept";
  static bool is_in(const ResultHeader& header) { return header.seen; }

  static constexpr std::tuple kColumns{
      Column<Rows, std::array<std::int32_t, 3>>{"cell", &Rows::cell, in_every_result, check_cells},
      Column<Rows, std::uint64_t>{"parts", &Rows::parts, in_every_result, check_parts}};

  static constexpr auto kOrder = &Rows::cell;
  static constexpr const char* kOrderDataset = "cell";
  static bool may_follow(const std::array<std::int32_t, 3>& before,
                         const std::array<std::int32_t, 3>& after) {
    return before < after;
  }
  static constexpr const char* kExpectedOrder = "a cell after the one of the row before";
};

template <typename Rows>
inline constexpr std::size_t kColumnsOf = std::tuple_size_v<decltype(Table<Rows>::kColumns)>;

/// Calls visit(column) for each column of a table, in the order of the file.
template <typename Rows, typename Visit>
void for_each_column(Visit visit) {
  std::apply([&](const auto&... column) { (visit(column), ...); }, Table<Rows>::kColumns);
}

/// Calls visit(column, state) for each column of a table; `states` is a tuple or an array with one
/// state for each column.
template <typename Rows, typename States, typename Visit>
void for_each_column(States& states, Visit visit) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (visit(std::get<I>(Table<Rows>::kColumns), std::get<I>(states)), ...);
  }
  (std::make_index_sequence<kColumnsOf<Rows>>());
}

/// A tuple with one State<Value> for each column of a table.
template <typename Rows, template <typename> typename State>
using PerColumn = decltype(std::apply(
    [](const auto&... column) {
      return std::tuple<State<typename std::decay_t<decltype(column)>::Value>...>();
    },
    Table<Rows>::kColumns));

/// Follows the order of the rows of a table that come in pieces.
template <typename Rows>
class OrderOf {
 public:
  /// Index of the first of these rows, which follow those before, that is out of order; their
  /// number where none is.
  std::size_t take(const Rows& rows) {
    const auto& values = rows.*Table<Rows>::kOrder;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (last_ && !Table<Rows>::may_follow(*last_, values[i])) return i;
      if (!first_) first_ = values[i];
      last_ = values[i];
    }
    return values.size();
  }
  /// Whether these rows may stand after others.
  bool follows(const OrderOf& before) const {
    return !first_ || !before.last_ || Table<Rows>::may_follow(*before.last_, *first_);
  }
  /// Throws InputError for rows out of order.
  void check(const RowsRead& read, const Rows& rows) {
    const std::size_t row = take(rows);
    if (row == (rows.*Table<Rows>::kOrder).size()) return;
    read.refuse_row(Table<Rows>::kOrderDataset, row, Table<Rows>::kExpectedOrder);
  }

 private:
  std::optional<
      typename std::decay_t<decltype(std::declval<Rows>().*Table<Rows>::kOrder)>::value_type>
      first_, last_;
};

/// Removes all rows and keeps the memory.
template <typename Rows>
void clear_rows(Rows& rows) {
  for_each_column<Rows>([&](const auto& column) { (rows.*column.values).clear(); });
}

/// Appends row `i` of `from`, in the columns that a result with this header has and `from` too.
template <typename Rows>
void append_row(const ResultHeader& header, const Rows& from, std::size_t i, Rows& to) {
  for_each_column<Rows>([&](const auto& column) {
    const auto& values = from.*column.values;
    if (column.is_in(header) && !values.empty()) (to.*column.values).push_back(values[i]);
  });
}

/// Appends all rows of `from`.
template <typename Rows>
void append_rows(const Rows& from, Rows& to) {
  for_each_column<Rows>([&](const auto& column) {
    const auto& values = from.*column.values;
    (to.*column.values).insert((to.*column.values).end(), values.begin(), values.end());
  });
}

}  // namespace clearway
