#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "clearway/error.hpp"
#include "clearway/result.hpp"
#include "io/files/input_error.hpp"
#include "io/files/xxh64.hpp"
#include "io/result/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {

ResultReader::ResultReader(const std::filesystem::path& path, Parts parts)
    : file_(path, kResultKinds) {
  if (file_.kind() == 1) header_.part.emplace();
  read_result_facts(file_, header_, findings_);
  std::apply([this](auto&... table) { (open(table), ...); }, tables_);
  if (header_.profile > 0 && profile_rows() != header_.poses) {
    refuse(name(), "/profile has " + std::to_string(profile_rows()) +
                       " rows, expected one for each of " + std::to_string(header_.poses) +
                       " poses");
  }
  if (parts == Parts::kAccepted || !header_.part) return;
  throw InputError(name() + ": is " + in_words(header_.part->shard) +
                       " of a result, and says nothing of the rest",
                   Remedy::kMerge);
}

template <typename Rows>
void ResultReader::open(StoredTable<Rows>& table) const {
  if (!Table<Rows>::is_in(header_)) return;
  bool first = true;
  for_each_column<Rows>(table.columns, [&](const auto& column, auto& stored) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    if (!column.is_in(header_)) return;
    stored = file_.column<Value>(std::string(Table<Rows>::kGroup) + "/" + column.dataset);
    if (!std::exchange(first, false) && stored->rows() != table.rows) {
      refuse(name(),
             std::string("the datasets of /") + Table<Rows>::kGroup + " differ in their rows");
    }
    table.rows = stored->rows();
  });
}

std::uint64_t ResultReader::identity() const {
  Json facts = file_.header();
  // The texts of warnings name files, which may be called otherwise the next time.
  for (Json& warning : facts["warnings"]) warning = warning["code"];
  const std::string text = indented_text(facts, -1);
  return xxh64(std::as_bytes(std::span(text)));
}

template <typename Rows>
std::uint64_t ResultReader::table_hash() const {
  if (!Table<Rows>::is_in(header_)) return 0;
  ColumnHashes hashes;
  for_each_column<Rows>(table<Rows>().columns, [&](const auto&, const auto& stored) {
    if (stored) hashes.add_digest(stored->hash());
  });
  return hashes.digest();
}

template <typename Rows, typename Value>
void ResultReader::read_column(const Column<Rows, Value>& column, const StoredValues<Value>& stored,
                               std::uint64_t first, std::vector<Value>& out) const {
  stored.read(first, out, [&](std::uint64_t row, std::span<const Value> values) {
    column.check({name(), header_, Table<Rows>::kGroup, row}, column.dataset, values);
  });
}

template <typename Rows>
void ResultReader::read(std::uint64_t first, std::size_t count, Rows& out,
                        OrderOf<Rows>& order) const {
  for_each_column<Rows>(table<Rows>().columns, [&](const auto& column, const auto& stored) {
    auto& values = out.*column.values;
    values.resize(stored ? count : 0);
    if (stored) read_column(column, *stored, first, values);
  });
  const RowsRead read{name(), header_, Table<Rows>::kGroup, first};
  order.check(read, out);
  if constexpr (requires { Table<Rows>::check(read, out); }) Table<Rows>::check(read, out);
}

template <typename Rows, typename Value>
std::vector<Value> ResultReader::column(std::vector<Value> Rows::*values) const {
  std::vector<Value> out(rows<Rows>());
  for_each_column<Rows>(table<Rows>().columns, [&](const auto& column, const auto& stored) {
    if constexpr (std::is_same_v<decltype(column.values), std::vector<Value> Rows::*>) {
      if (column.values != values) return;
      if (!stored) return out.clear();
      read_column(column, *stored, 0, out);
    }
  });
  return out;
}

template std::uint64_t ResultReader::table_hash<Collisions>() const;
template void ResultReader::read(std::uint64_t, std::size_t, Collisions&,
                                 OrderOf<Collisions>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, Clearances&,
                                 OrderOf<Clearances>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, ProfileRows&,
                                 OrderOf<ProfileRows>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, Nearby&, OrderOf<Nearby>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, UnseenCubes&,
                                 OrderOf<UnseenCubes>&) const;
template void ResultReader::read(std::uint64_t, std::size_t, SweptCells&,
                                 OrderOf<SweptCells>&) const;
template std::vector<std::uint64_t> ResultReader::column(
    std::vector<std::uint64_t> Collisions::*) const;
template std::vector<std::uint64_t> ResultReader::column(
    std::vector<std::uint64_t> Nearby::*) const;
template std::vector<Vec3> ResultReader::column(std::vector<Vec3> Collisions::*) const;
template std::vector<std::uint32_t> ResultReader::column(
    std::vector<std::uint32_t> Collisions::*) const;

Result::Result(const std::filesystem::path& path) : reader_(std::make_unique<ResultReader>(path)) {}
Result::~Result() = default;
Result::Result(Result&&) noexcept = default;
Result& Result::operator=(Result&&) noexcept = default;

std::uint64_t Result::size() const { return reader_->collisions(); }
const QueryParameters& Result::parameters() const { return reader_->header(); }
std::uint64_t Result::environment_points() const { return reader_->header().environment_points; }
const IgnoredPointCounts& Result::ignored() const { return reader_->header().ignored; }
std::uint64_t Result::poses() const { return reader_->header().poses; }
Answer Result::answer() const { return answer_of(*reader_); }
const std::vector<Message>& Result::warnings() const { return reader_->findings().warnings; }

Collisions Result::collisions() const { return reader_->all<Collisions>(); }

std::vector<std::uint64_t> Result::source() const { return reader_->column(&Collisions::source); }
std::vector<Vec3> Result::xyz() const { return reader_->column(&Collisions::xyz); }
std::vector<std::uint32_t> Result::first_pose() const {
  return reader_->column(&Collisions::first_pose);
}
std::vector<std::uint32_t> Result::last_pose() const {
  return reader_->column(&Collisions::last_pose);
}
std::vector<std::uint32_t> Result::first_body() const { return reader_->column(&Collisions::body); }
const std::vector<std::string>& Result::bodies() const { return reader_->header().bodies; }

UnseenCubes Result::unseen() const { return reader_->all<UnseenCubes>(); }
Nearby Result::near() const { return reader_->all<Nearby>(); }
Clearances Result::clearance() const { return reader_->all<Clearances>(); }

Profile Result::profile() const {
  auto out = reader_->all<ProfileRows>();
  for (const auto& [first, last] : reader_->findings().without_bodies) {
    std::fill(out.distance.begin() + first, out.distance.begin() + last + 1,
              std::numeric_limits<double>::quiet_NaN());
  }
  return std::move(static_cast<Profile&>(out));
}

double Result::model_spacing() const { return reader_->header().notes.model_spacing; }

ModelAxes Result::model_axes() const { return reader_->header().notes.model_axes; }

Box Result::model_box() const { return reader_->header().model_box; }

}  // namespace clearway
