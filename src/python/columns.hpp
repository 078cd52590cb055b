#pragma once

#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/query.hpp"
#include "python/arrays.hpp"
#include "python/python.hpp"

/// The tables of an answer as arrays, for results that are read from a file and for answers in
/// memory.
namespace clearway::python {

/// Columns that the table does not have are None.
struct CollisionColumns {
  py::array source, xyz, point_class;
  py::object first_pose = py::none(), last_pose = py::none(), body = py::none(),
             certain = py::none(), depth = py::none(), depth_source = py::none();
};
struct ClearanceColumns {
  py::array source, xyz, distance, pose, body, point_class;
};
struct ProfileColumns {
  py::array source, xyz, distance, chainage, point_class;
};
struct UnseenColumns {
  py::array cube, first_pose, group;
};

/// Makes arrays that take over the vectors of a table, which belong to the caller alone.
struct OwnArrays {
  template <typename Value>
  py::array operator()(std::vector<Value>& values) const {
    return to_array(std::move(values));
  }
};

/// Makes arrays over the vectors of a table that `owner` keeps. They cannot be written to, because
/// all arrays of the table share it.
struct SharedArrays {
  py::object owner;

  template <typename Value>
  py::array operator()(const std::vector<Value>& values) const {
    py::array array = array_over(values, owner);
    array.attr("flags").attr("writeable") = false;
    return array;
  }
};

// Each of the following takes a table of the library, and one of the two makers of arrays. Columns
// that the query did not ask for become None.

template <typename Table, typename Make>
CollisionColumns collision_columns(Table& table, const QueryParameters& asked, bool has_bodies,
                                   const Make& make) {
  CollisionColumns columns;
  columns.source = make(table.source);
  columns.xyz = make(table.xyz);
  columns.point_class = make(table.point_class);
  if (asked.first_pose) {
    columns.first_pose = make(table.first_pose);
    if (has_bodies) columns.body = make(table.body);
  }
  if constexpr (requires { table.last_pose; }) {
    if (asked.first_pose) columns.last_pose = make(table.last_pose);
    if (asked.has_budget()) columns.certain = make(table.certain).attr("view")("bool");
    if (asked.depth) {
      columns.depth = make(table.depth);
      columns.depth_source = make(table.depth_source);
    }
  }
  return columns;
}

template <typename Table, typename Make>
py::object clearance_columns(Table& table, const QueryParameters& asked, const Make& make) {
  if (!(asked.clearance > 0)) return py::none();
  return py::cast(ClearanceColumns{make(table.source), make(table.xyz), make(table.distance),
                                   make(table.pose), make(table.body), make(table.point_class)});
}

template <typename Table, typename Make>
py::object profile_columns(Table& table, const QueryParameters& asked, const Make& make) {
  if (!(asked.profile > 0)) return py::none();
  return py::cast(ProfileColumns{make(table.source), make(table.xyz), make(table.distance),
                                 make(table.chainage), make(table.point_class)});
}

template <typename Table, typename Make>
py::object near_columns(Table& table, const QueryParameters& asked, bool has_bodies,
                        const Make& make) {
  if (!asked.has_budget()) return py::none();
  return py::cast(collision_columns(table, asked, has_bodies, make));
}

template <typename Table, typename Make>
py::object unseen_columns(Table& table, const QueryParameters& asked, const Make& make) {
  if (!asked.seen) return py::none();
  return py::cast(UnseenColumns{make(table.cube), make(table.first_pose), make(table.group)});
}

}  // namespace clearway::python
