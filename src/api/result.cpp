#include "clearway/result.hpp"

#include <algorithm>
#include <limits>

#include "io/result/answer.hpp"
#include "io/result/result.hpp"

namespace clearway {

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

std::vector<std::uint64_t> Result::source() const {
  std::vector<std::uint64_t> out(size());
  reader_->read_source(0, out);
  return out;
}

std::vector<Vec3> Result::xyz() const {
  std::vector<Vec3> out(size());
  reader_->read_xyz(0, out);
  return out;
}

std::vector<std::uint32_t> Result::first_pose() const {
  if (!parameters().first_pose) return {};
  std::vector<std::uint32_t> out(size());
  reader_->read_first_pose(0, out);
  return out;
}

std::vector<std::uint32_t> Result::last_pose() const {
  if (!reader_->header().last_pose) return {};
  std::vector<std::uint32_t> out(size());
  reader_->read_last_pose(0, out);
  return out;
}

const std::vector<std::string>& Result::bodies() const { return reader_->header().bodies; }

std::vector<std::uint32_t> Result::first_body() const {
  if (!reader_->header().has_first_bodies()) return {};
  std::vector<std::uint32_t> out(size());
  reader_->read_first_body(0, out);
  return out;
}

Clearances Result::clearance() const {
  const std::uint64_t rows = reader_->clearances();
  Clearances out;
  out.source.resize(rows);
  out.xyz.resize(reader_->header().has_clearance_xyz() ? rows : 0);
  out.distance.resize(rows);
  out.pose.resize(rows);
  if (rows > 0) reader_->read_clearances(0, out.source, out.xyz, out.distance, out.pose);
  if (bodies().empty()) return out;
  out.body.resize(rows);
  if (rows > 0) reader_->read_clearance_body(0, out.body);
  return out;
}

Profile Result::profile() const {
  const std::uint64_t rows = reader_->profile_rows();
  Profile out;
  out.distance.resize(rows);
  out.source.resize(rows);
  out.xyz.resize(rows);
  out.chainage.resize(rows);
  if (rows > 0) reader_->read_profile(0, out.distance, out.source, out.xyz, out.chainage);
  for (const auto& [first, last] : reader_->findings().without_bodies) {
    std::fill(out.distance.begin() + first, out.distance.begin() + last + 1,
              std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

double Result::model_spacing() const { return reader_->header().model_spacing.metres; }

std::optional<Box> Result::model_box() const {
  if (!reader_->header().has_model_box()) return std::nullopt;
  return reader_->header().model_box;
}

}  // namespace clearway
