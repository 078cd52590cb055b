#include "clearway/store.hpp"

#include "io/store/store_reader.hpp"

namespace clearway {

Store::Store(const std::filesystem::path& path)
    : path_(path), reader_(std::make_unique<StoreReader>(path)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

std::uint64_t Store::point_count() const { return reader_->point_count(); }
std::uint64_t Store::cell_count() const { return reader_->cells().size(); }

Box Store::box() const {
  if (reader_->tree().empty()) return {};
  return position_box(reader_->quantisation(), reader_->tree()[0].box);
}

std::vector<std::uint64_t> Store::class_points() const {
  const auto& classes = reader_->metadata().classes;
  if (!classes) return {};
  return {classes->points.begin(), classes->points.end()};
}

const std::string& Store::crs_wkt() const { return reader_->metadata().crs_wkt; }
std::string Store::length_unit() const { return to_string(reader_->metadata().unit); }

std::vector<Message> Store::warnings() const { return store_warnings(reader_->metadata()); }

double Store::metres_per_unit() const {
  const double metres = metres_of(reader_->metadata().unit);
  return metres > 0 ? metres : 1;
}

}  // namespace clearway
