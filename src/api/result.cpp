#include "clearway/result.hpp"

#include <algorithm>
#include <limits>
#include <utility>

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

Collisions Result::collisions() const {
  Collisions out;
  reader_->read(0, reader_->rows<Collisions>(), out);
  return out;
}

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

Clearances Result::clearance() const {
  Clearances out;
  reader_->read(0, reader_->rows<Clearances>(), out);
  return out;
}

Profile Result::profile() const {
  ProfileRows out;
  reader_->read(0, reader_->rows<ProfileRows>(), out);
  for (const auto& [first, last] : reader_->findings().without_bodies) {
    std::fill(out.distance.begin() + first, out.distance.begin() + last + 1,
              std::numeric_limits<double>::quiet_NaN());
  }
  return std::move(static_cast<Profile&>(out));
}

double Result::model_spacing() const { return reader_->header().model_spacing.metres; }

std::optional<Box> Result::model_box() const {
  if (!reader_->header().has_model_box()) return std::nullopt;
  return reader_->header().model_box;
}

}  // namespace clearway
