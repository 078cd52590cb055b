#include "io/store/convert/same_scans.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "core/messages/messages.hpp"
#include "core/util/format.hpp"

namespace clearway {
namespace {

constexpr std::size_t kTableSize = 1024;  // a power of two, far greater than the number of places

/// A hash of an integer. Source: Vigna, splitmix64.
std::uint64_t mixed(std::uint64_t value) {
  value += 0x9E3779B97F4A7C15;
  value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9;
  value = (value ^ (value >> 27)) * 0x94D049BB133111EB;
  return value ^ (value >> 31);
}

/// The half of a group of 2^level points that its sample is in, 0 or 1.
std::uint64_t half_of(unsigned level, std::uint64_t group) { return mixed(group * 64 + level) & 1; }

std::size_t slot_of(const PlaceQuanta& q) {
  const auto hash = static_cast<std::uint32_t>(q[0]) * 0x9E3779B1u ^
                    static_cast<std::uint32_t>(q[1]) * 0x85EBCA77u ^
                    static_cast<std::uint32_t>(q[2]) * 0xC2B2AE3Du;
  return hash >> 22;
}

}  // namespace

void PlaceSample::add(const QuantaBatch& batch) {
  while (next_ < seen_ + batch.quanta.size()) {
    const PlaceQuanta& at = batch.quanta[next_ - seen_];
    samples_.push_back({at, measured(batch, at, quantisation_),
                        static_cast<std::uint32_t>(batch.file), batch.turn.has_value()});
    ++group_;
    if (samples_.size() == kMostSamples) thin();
    choose_next();
  }
  seen_ += batch.quanta.size();
}

/// Joins each two groups into one and keeps one sample, from the half that the hash selects.
void PlaceSample::thin() {
  ++level_;
  for (std::size_t i = 0; 2 * i < samples_.size(); ++i) {
    samples_[i] = samples_[2 * i + half_of(level_, i)];
  }
  samples_.resize(samples_.size() / 2);
  group_ = samples_.size();
}

void PlaceSample::choose_next() {
  next_ = group_;
  for (unsigned level = level_; level > 0; --level) next_ = 2 * next_ + half_of(level, next_);
}

std::vector<PlaceQuanta> PlaceSample::suspects() const {
  std::vector<PlaceQuanta> sorted;
  for (const SampledPoint& point : samples_) sorted.push_back(point.at);
  std::sort(sorted.begin(), sorted.end());
  std::vector<PlaceQuanta> found;
  // Half of the expected number, because a sample varies.
  const double least =
      std::max(kSamePlaceShare / 2 * static_cast<double>(sorted.size()),
               0.5 * static_cast<double>(kSamePlacePoints) / static_cast<double>(1ULL << level_));
  for (auto begin = sorted.begin(); begin != sorted.end();) {
    const auto end = std::upper_bound(begin, sorted.end(), *begin);
    if (static_cast<double>(end - begin) >= least) found.push_back(*begin);
    begin = end;
  }
  return found;
}

PlaceCounter::PlaceCounter(const std::vector<PlaceQuanta>& places, StepJudge steps)
    : steps_(std::move(steps)) {
  if (!places.empty()) table_.resize(kTableSize);
  for (const PlaceQuanta& q : places) {
    places_.push_back({.at = q, .first = ~std::uint64_t{0}});
    std::size_t slot = slot_of(q);
    while (table_[slot] != 0) slot = (slot + 1) % kTableSize;
    table_[slot] = static_cast<std::uint16_t>(places_.size());
  }
}

void PlaceCounter::add(const QuantaBatch& batch) {
  steps_.add(batch, cubes_mutex_);
  if (places_.empty()) return;
  std::vector<Place> found(places_.size());
  for (std::size_t i = 0; i < batch.quanta.size(); ++i) {
    const PlaceQuanta& q = batch.quanta[i];
    std::size_t slot = slot_of(q);
    while (table_[slot] != 0 && places_[table_[slot] - 1].at != q) slot = (slot + 1) % kTableSize;
    if (table_[slot] == 0) continue;
    Place& place = found[table_[slot] - 1];
    place.last = batch.source(i);
    if (place.count++ == 0) place.first = place.last;
  }
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].count == 0) continue;
    places_[i].count += found[i].count;
    places_[i].first = std::min(places_[i].first, found[i].first);
    places_[i].last = std::max(places_[i].last, found[i].last);
  }
}

std::vector<PlaceCounter::Place> PlaceCounter::crowded(std::uint64_t points) const {
  std::vector<Place> out;
  std::copy_if(places_.begin(), places_.end(), std::back_inserter(out), [=](const Place& place) {
    return place.count >= kSamePlacePoints &&
           static_cast<double>(place.count) > kSamePlaceShare * static_cast<double>(points);
  });
  std::stable_sort(out.begin(), out.end(),
                   [](const Place& a, const Place& b) { return a.count > b.count; });
  return out;
}

void warn_of_same_scans(std::span<const std::filesystem::path> files,
                        std::span<const SourceFile> sources, std::span<const FileBox> boxes,
                        MessageLog& log) {
  constexpr std::size_t kNamed = 3;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::size_t> first_with;
  std::size_t count = 0;
  std::uint64_t points = 0;
  std::string names;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (boxes[i].points == 0) continue;
    const auto [first, is_new] = first_with.try_emplace({sources[i].bytes, sources[i].xxh64}, i);
    if (is_new) continue;
    points += boxes[i].points;
    if (count++ >= kNamed) continue;
    std::error_code ignored;
    const std::filesystem::path& earlier = files[first->second];
    const bool one_file = std::filesystem::equivalent(files[i], earlier, ignored);
    names += (names.empty() ? "" : "; ") + files[i].string() +
             (one_file ? " is the same file as " : " has the same bytes as ") + earlier.string();
  }
  if (count == 0) return;
  if (count > kNamed) names += "; and " + std::to_string(count - kNamed) + " more";
  log.warn("same-scan", names + ": " + format_count(points) + " points are in the store twice",
           {{"files", count}, {"points", points}});
}

}  // namespace clearway
