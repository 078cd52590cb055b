#include "io/result/check_results.hpp"

#include <span>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "core/describe/query.hpp"
#include "core/query/ignored_points.hpp"
#include "core/util/format.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/result.hpp"
#include "io/scans/length_unit.hpp"
#include "io/scans/requantize.hpp"

namespace clearway {
namespace {

void check_points(const ResultReader& result, std::span<const std::uint64_t> source,
                  std::span<const Vec3> xyz) {
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    if (source[i] == Profile::kNoPoint) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!quantum_at(result.header().quantisation, axis, xyz[i][axis])) {
        throw InputError(result.name() + ": a coordinate of source point " +
                         std::to_string(source[i]) + " is not on the environment's scale");
      }
    }
  }
}

template <typename Rows>
void check_table(const ResultReader& result, Progress& progress) {
  RowStream<Rows> stream(result);
  for (Rows rows; stream.read(rows);) {
    check_points(result, rows.source, rows.xyz);
    progress.advance(rows.size());
  }
}

/// Reads a table that has no points, which checks its values and hashes.
template <typename Rows>
void check_rows(const ResultReader& result, Progress& progress) {
  RowStream<Rows> stream(result);
  for (Rows rows; stream.read(rows);) progress.advance(rows.size());
}

}  // namespace

std::optional<std::string> verify_result(const ResultReader& result, Progress& progress) {
  progress.begin("verify",
                 result.collisions() + result.clearances() + result.profile_rows() + result.near() +
                     result.rows<UnseenCubes>() + result.rows<SweptCells>(),
                 "rows");
  std::optional<std::string> fault;
  try {
    check_table<Collisions>(result, progress);
    check_table<Clearances>(result, progress);
    check_table<ProfileRows>(result, progress);
    check_table<Nearby>(result, progress);
    check_rows<UnseenCubes>(result, progress);
    check_rows<SweptCells>(result, progress);
  } catch (const InputError& error) {
    fault = error.what();
  }
  progress.end();
  return fault;
}

bool is_intact_result(const std::filesystem::path& file, const ResultHeader& header,
                      Progress& progress) {
  try {
    const ResultReader result(file, Parts::kAccepted);
    return same_answer(result.header(), header) && !verify_result(result, progress);
  } catch (const InputError&) {
    return false;
  }
}

namespace {

std::string content_text(std::uint64_t count, const char* unit, std::uint64_t hash) {
  return std::to_string(count) + " " + unit + ", hash " + hash_text(hash);
}

std::string quantisation_text(const Quantisation& quantisation) {
  std::string text = "scale";
  for (const double scale : quantisation.scale) text.append(" ").append(format_number(scale));
  text += ", offset";
  for (const double offset : quantisation.offset) text.append(" ").append(format_number(offset));
  return text;
}

/// A number with its unit, such as "0.1 m".
std::string number_text(double value, FieldUnit unit) {
  const std::string symbol(symbol_of(unit));
  return format_length(value) + (symbol.empty() ? "" : " " + symbol);
}

/// What the question says of a field, in words.
template <typename Value>
std::string field_text(const Field<QueryParameters, Value>& field, const ResultHeader& header) {
  const Value& value = field.of(header);
  if constexpr (std::is_same_v<Value, bool>) {
    return value ? field.yes : field.no;
  } else if constexpr (std::is_same_v<Value, std::uint32_t>) {
    return std::to_string(value);
  } else if constexpr (std::is_same_v<Value, double>) {
    const bool is_set = value > 0 || field.unit == FieldUnit::kNone || field.is_required;
    return is_set ? number_text(value, field.unit) : field.no;
  } else {
    return value ? number_text(*value, field.unit) : field.no;
  }
}

std::string bodies_text(const ResultHeader& header) {
  return header.bodies.empty() ? "one model" : with_commas(header.bodies);
}

std::string classes_text(const ResultHeader& header) {
  return header.has_classes() ? "hash " + hash_text(header.classes_hash) : "none";
}

/// The lists of what was to be ignored in words.
std::string ignored_lists_text(const ResultHeader& header) {
  if (!header.ignores_points()) return "none";
  const std::string boxes =
      header.ignore_boxes.empty() ? "" : ": " + boxes_text(header.ignore_boxes);
  return ignored_text(header) + boxes;
}

/// "0.25, none" for two bodies; "none" where no body has a floor.
std::string body_floors_text(const ResultHeader& header) {
  std::string text;
  for (const std::optional<double>& floor : header.body_floors) {
    text += (text.empty() ? "" : ", ") + (floor ? format_number(*floor) : "none");
  }
  return text.empty() ? "none" : text;
}

std::string crs_text(const ResultHeader& header) {
  return header.crs_wkt.empty() ? "none" : header.crs_wkt;
}

std::string model_text(const ResultHeader& header) {
  if (header.model_triangles == 0) {
    return content_text(header.model_points, "points", header.model_hash);
  }
  const std::string solids =
      header.model_solids > 0 ? " with " + counted(header.model_solids, "solid") : "";
  return content_text(header.model_triangles, ("triangles" + solids).c_str(), header.model_hash);
}

std::string margins_text(const ResultHeader& header) {
  if (!header.budget) return "none";
  return format_length(header.budget->clear()) + " m for clear, " +
         format_length(header.budget->conflict()) + " m for conflict";
}

class Differences {
 public:
  void add(std::string what, std::string a, std::string b) {
    if (a != b) out_.push_back({std::move(what), std::move(a), std::move(b)});
  }
  std::vector<QueryDifference> take() { return std::move(out_); }

 private:
  std::vector<QueryDifference> out_;
};

void add_question(const ResultHeader& a, const ResultHeader& b, Differences& out) {
  out.add("model", model_text(a), model_text(b));
  out.add("bodies", bodies_text(a), bodies_text(b));
  out.add("floors of bodies", body_floors_text(a), body_floors_text(b));
  out.add("trajectory", content_text(a.poses, "poses", a.trajectory_hash),
          content_text(b.poses, "poses", b.trajectory_hash));
  for_each_field(kQueryValues, [&](const auto& field) {
    out.add(field.topic, field_text(field, a), field_text(field, b));
  });
  out.add("margins of the error budget", margins_text(a), margins_text(b));
}

class Merge {
 public:
  Merge(const ResultReader& a, const ResultReader& b, std::size_t kept)
      : a_(a), b_(b), kept_(kept) {
    out_.in_a = a.collisions();
    out_.in_b = b.collisions();
    out_.queries = query_differences(a.header(), b.header());
    if (a.header().first_pose && b.header().first_pose) {
      out_.differing_first_poses = out_.differing_last_poses = 0;
    }
    if (a.header().depth && b.header().depth) out_.differing_depths = 0;
    same_bodies_ = a.header().bodies == b.header().bodies;
  }

  Comparison run() {
    merge_rows(
        a_, b_,
        [&] {
          ++out_.only_in_a;
          keep({Kind::kOnlyInA, a_.source(), a_.get(&Collisions::xyz),
                a_.find(&Collisions::first_pose), std::nullopt});
        },
        [&] {
          ++out_.only_in_b;
          keep({Kind::kOnlyInB, b_.source(), b_.get(&Collisions::xyz), std::nullopt,
                b_.find(&Collisions::first_pose)});
        },
        [&] { common(); });
    return std::move(out_);
  }

 private:
  using Kind = PointDifference::Kind;

  void common() {
    ++out_.common;
    const PointDifference point{Kind::kFirstPose, a_.source(), a_.get(&Collisions::xyz),
                                a_.find(&Collisions::first_pose), b_.find(&Collisions::first_pose)};
    const bool same_body =
        !same_bodies_ || a_.find(&Collisions::body) == b_.find(&Collisions::body);
    if (out_.differing_first_poses && (point.first_pose_a != point.first_pose_b || !same_body)) {
      ++*out_.differing_first_poses;
      keep(point);
    }
    if (out_.differing_last_poses &&
        a_.find(&Collisions::last_pose) != b_.find(&Collisions::last_pose)) {
      ++*out_.differing_last_poses;
      keep({Kind::kLastPose, point.source, point.xyz, point.first_pose_a, point.first_pose_b,
            a_.find(&Collisions::last_pose), b_.find(&Collisions::last_pose)});
    }
    // The free point says where there is none, so that NaN is not compared.
    const auto source_a = a_.find(&Collisions::depth_source);
    const bool is_free = source_a && *source_a != Collisions::kNoPoint;
    if (out_.differing_depths &&
        (source_a != b_.find(&Collisions::depth_source) ||
         (is_free && a_.find(&Collisions::depth) != b_.find(&Collisions::depth)))) {
      ++*out_.differing_depths;
      keep({Kind::kDepth,
            point.source,
            point.xyz,
            point.first_pose_a,
            point.first_pose_b,
            {},
            {},
            a_.find(&Collisions::depth),
            b_.find(&Collisions::depth),
            source_a,
            b_.find(&Collisions::depth_source)});
    }
    if (a_.get(&Collisions::xyz) != b_.get(&Collisions::xyz)) {
      ++out_.differing_coordinates;
      keep({Kind::kCoordinates, point.source, point.xyz, point.first_pose_a, point.first_pose_b});
    }
  }

  void keep(const PointDifference& point) {
    if (out_.points.size() < kept_) out_.points.push_back(point);
  }

  CollisionCursor a_, b_;
  std::size_t kept_;
  bool same_bodies_;
  Comparison out_;
};

template <typename Rows>
TableComparison compare_tables(const ResultReader& a, const ResultReader& b) {
  TableComparison out;
  out.in_a = a.rows<Rows>();
  out.in_b = b.rows<Rows>();
  const bool bodies = a.header().bodies == b.header().bodies;
  RowCursor<Rows> from_a(a), from_b(b);
  merge_rows(
      from_a, from_b, [&] { ++out.only_in_a; }, [&] { ++out.only_in_b; },
      [&] {
        ++out.common;
        bool same = true;
        for_each_column<Rows>([&](const auto& column) {
          const auto in_a = from_a.find(column.values), in_b = from_b.find(column.values);
          const std::string_view what = column.dataset;
          if (what == "class" || (what == "body" && !bodies)) return;
          if (in_a && in_b) same = same && *in_a == *in_b;
        });
        if (!same) ++out.differing;
      });
  return out;
}

bool has_same_path(const ResultHeader& a, const ResultHeader& b) {
  return a.poses == b.poses && a.trajectory_hash == b.trajectory_hash;
}

ProfileComparison compare_profiles(const ResultReader& a, const ResultReader& b) {
  ProfileComparison out;
  RowStream<ProfileRows> from_a(a), from_b(b);
  ProfileRows rows_a, rows_b;
  while (from_a.read(rows_a) && from_b.read(rows_b)) {
    for (std::size_t i = 0; i < rows_a.size(); ++i, ++out.poses) {
      const bool none = rows_a.source[i] == Profile::kNoPoint;
      if (rows_a.source[i] == rows_b.source[i] && rows_a.distance[i] == rows_b.distance[i] &&
          rows_a.chainage[i] == rows_b.chainage[i] && (none || rows_a.xyz[i] == rows_b.xyz[i])) {
        continue;
      }
      ++out.differing;
      if (!out.first) out.first = out.poses;
    }
  }
  from_b.read(rows_b);  // at its end, each stream checks the hash
  return out;
}

}  // namespace

std::vector<QueryDifference> question_differences(const ResultHeader& a, const ResultHeader& b) {
  Differences out;
  add_question(a, b, out);
  out.add("ignored points", ignored_lists_text(a), ignored_lists_text(b));
  out.add("CRS", crs_text(a), crs_text(b));
  return out.take();
}

std::vector<QueryDifference> query_differences(const ResultHeader& a, const ResultHeader& b) {
  Differences out;
  out.add("environment", environment_text(a), environment_text(b));
  out.add("classes", classes_text(a), classes_text(b));
  add_question(a, b, out);
  out.add("ignored points", ignored_lists_text(a), ignored_lists_text(b));
  out.add("quantisation", quantisation_text(a.quantisation), quantisation_text(b.quantisation));
  out.add("CRS", crs_text(a), crs_text(b));
  return out.take();
}

Comparison compare_results(const ResultReader& a, const ResultReader& b, std::size_t kept) {
  if (a.header().environment_points != b.header().environment_points ||
      a.header().environment_hash != b.header().environment_hash) {
    throw InputError(
        a.name() + " and " + b.name() + ": results about different environments (" +
        environment_text(a.header()) + "; " + environment_text(b.header()) +
        "), whose point indices cannot be compared. clearway compare --conflicts compares "
        "the places of results of two scans");
  }
  Comparison out = Merge(a, b, kept).run();
  if (a.header().clearance > 0 && b.header().clearance > 0) {
    out.clearances = compare_tables<Clearances>(a, b);
  }
  if (a.header().budget && b.header().budget) out.near = compare_tables<Nearby>(a, b);
  if (a.header().profile > 0 && b.header().profile > 0 && has_same_path(a.header(), b.header())) {
    out.profiles = compare_profiles(a, b);
  }
  return out;
}

}  // namespace clearway
