#include "io/store/convert/origin_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/files/mapped_file.hpp"
#include "io/files/text_number.hpp"
#include "io/files/xxh64.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/text/text_table.hpp"

namespace clearway {
namespace {

constexpr double kMostQuantum = 0x1p62;
constexpr double kFarMetres = 1000;  // distance from all points above which a warning is due
constexpr double kNearMetres = 100;  // likewise, where all origins are at 0 0 0

double percentage(std::uint64_t part, std::uint64_t all) {
  return 100 * static_cast<double>(part) / static_cast<double>(all);
}

std::string text_of(const Vec3& p) {
  return format_digits(p.x, 9) + " " + format_digits(p.y, 9) + " " + format_digits(p.z, 9);
}

double distance(const Box& box, const Vec3& p) {
  double squares = 0;
  for (int k = 0; k < 3; ++k) {
    squares += std::pow(std::max({box.lo[k] - p[k], 0.0, p[k] - box.hi[k]}), 2);
  }
  return std::sqrt(squares);
}

}  // namespace

void OriginTable::rest_on(const std::string& what) { bases_.push_back({what, 0}); }

OriginQuanta quanta_of_origin(const Quantisation& quantisation, const Vec3& origin,
                              const std::string& name) {
  OriginQuanta q{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double at = origin[static_cast<int>(k)];
    const double quantum = (at - quantisation.offset[k]) / quantisation.scale[k];
    if (!(std::abs(quantum) <= kMostQuantum)) {
      refuse(name, "an origin at " + text_of(origin) + ", which is too far away for steps of " +
                       format_digits(quantisation.scale[k], 9));
    }
    q[k] = std::llround(quantum);
  }
  return q;
}

/// The slot of these integers, or the free one where they belong.
std::size_t OriginTable::slot_of(const OriginQuanta& quanta) const {
  std::uint64_t hash = 0;
  for (const std::int64_t q : quanta) {
    hash = (hash ^ static_cast<std::uint64_t>(q)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  }
  std::size_t slot = hash & (slots_.size() - 1);
  while (slots_[slot] != 0 && quanta_[slots_[slot] - 1] != quanta) {
    slot = (slot + 1) & (slots_.size() - 1);
  }
  return slot;
}

/// 1 + the index of these integers in quanta_, to which they are appended where they are new.
std::uint32_t OriginTable::number_of(const OriginQuanta& quanta) {
  if (!quanta_.empty() && !runs_.empty() && runs_.back().number > 0 &&
      quanta_[runs_.back().number - 1] == quanta) {
    return runs_.back().number;
  }
  if (slots_.size() <= 2 * quanta_.size()) {
    slots_.assign(std::max<std::size_t>(16, 4 * quanta_.size()), 0);
    slots_.resize(std::bit_ceil(slots_.size()));
    for (std::uint32_t i = 0; i < quanta_.size(); ++i) slots_[slot_of(quanta_[i])] = i + 1;
  }
  std::uint32_t& slot = slots_[slot_of(quanta)];
  if (slot == 0) {
    quanta_.push_back(quanta);
    slot = static_cast<std::uint32_t>(quanta_.size());
  }
  return slot;
}

void OriginTable::add(std::uint64_t first, const std::optional<Vec3>& origin,
                      const std::string& name) {
  std::optional<OriginQuanta> quanta;
  if (origin) quanta = quanta_of_origin(quantisation_, *origin, name);
  add_quanta(first, quanta, name);
}

void OriginTable::add_quanta(std::uint64_t first, const std::optional<OriginQuanta>& origin,
                             const std::string& name) {
  std::uint32_t number = 0;
  if (origin) {
    number = number_of(*origin);
    ++with_origin_;
    for (std::size_t k = 0; k < 3; ++k) {
      const double zero = -quantisation_.offset[k] / quantisation_.scale[k];
      all_zero_ = all_zero_ && std::abs(static_cast<double>((*origin)[k]) - zero) <= 0.5;
    }
  }
  const auto basis = static_cast<std::uint32_t>(bases_.empty() ? 0 : bases_.size() - 1);
  if (!runs_.empty() && runs_.back().number == number && runs_.back().basis == basis) return;
  runs_.push_back({first, number, basis});
  const std::uint64_t bytes = runs_.size() * sizeof(Run) +
                              3 * quanta_.size() * sizeof(OriginQuanta) +
                              slots_.size() * sizeof(std::uint32_t);
  if (bytes > most_bytes_ || quanta_.size() >= std::numeric_limits<std::uint32_t>::max()) {
    throw ResourceError(name + ": " + format_count(runs_.size()) + " changes of the origin take " +
                            format_size(bytes) + ", and there may be more; origins may take " +
                            format_size(most_bytes_) + ", a quarter of the memory",
                        Remedy::kMoreMemory);
  }
}

void OriginTable::finish() {
  slots_ = {};
  const std::vector<OriginQuanta> given = quanta_;
  std::sort(quanta_.begin(), quanta_.end());
  quanta_.shrink_to_fit();
  for (Run& run : runs_) {
    if (run.number == 0) continue;
    const auto at = std::lower_bound(quanta_.begin(), quanta_.end(), given[run.number - 1]);
    run.number = static_cast<std::uint32_t>(1 + (at - quanta_.begin()));
  }
}

std::uint64_t OriginTable::allocated_bytes() const {
  return runs_.capacity() * sizeof(Run) + quanta_.capacity() * sizeof(OriginQuanta);
}

std::uint64_t OriginTable::end_of(std::size_t run) const {
  return run + 1 < runs_.size() ? runs_[run + 1].first : std::numeric_limits<std::uint64_t>::max();
}

/// The run of a source index that is not before run `from`.
std::size_t OriginTable::run_of(std::uint64_t source, std::size_t from) const {
  if (source < end_of(from)) return from;
  const auto after =
      std::upper_bound(runs_.begin() + static_cast<std::ptrdiff_t>(from), runs_.end(), source,
                       [](std::uint64_t wanted, const Run& run) { return wanted < run.first; });
  return static_cast<std::size_t>(after - runs_.begin()) - 1;
}

void OriginTable::count(const QuantaBatch& batch) {
  const std::size_t points = batch.quanta.size();
  for (std::size_t i = 0; i < points;) {
    counted_run_ = run_of(batch.source(i), counted_run_);
    const std::uint64_t rest = end_of(counted_run_) - batch.first_source;
    std::size_t end = static_cast<std::size_t>(std::min<std::uint64_t>(rest, points));
    if (!batch.offsets.empty()) {
      end = static_cast<std::size_t>(
          std::lower_bound(batch.offsets.begin(), batch.offsets.end(), rest) -
          batch.offsets.begin());
    }
    const Run& run = runs_[counted_run_];
    if (run.number > 0) bases_[run.basis].points += end - i;
    i = end;
  }
}

std::vector<std::uint64_t> OriginTable::counts() const {
  std::vector<std::uint64_t> counts;
  for (const OriginBasis& basis : bases_) counts.push_back(basis.points);
  return counts;
}

void OriginTable::set_counts(const std::vector<std::uint64_t>& counts) {
  for (std::size_t i = 0; i < std::min(counts.size(), bases_.size()); ++i) {
    bases_[i].points = counts[i];
  }
}

std::vector<std::uint32_t> OriginTable::numbers_of(std::span<const DistributedPoint> points) const {
  std::vector<std::uint32_t> numbers(points.size());
  std::size_t run = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    run = run_of(points[i].source_index(), run);
    numbers[i] = runs_[run].number;
  }
  return numbers;
}

std::optional<StoreOrigins> OriginTable::origins(std::uint64_t points) const {
  StoreOrigins out{.quanta = quanta_, .points_without = points};
  for (const OriginBasis& basis : bases_) {
    if (basis.points == 0) continue;
    out.points_without -= basis.points;
    const auto same = std::find_if(out.rest_on.begin(), out.rest_on.end(),
                                   [&](const OriginBasis& b) { return b.what == basis.what; });
    if (same == out.rest_on.end()) {
      out.rest_on.push_back(basis);
    } else {
      same->points += basis.points;
    }
  }
  if (out.rest_on.empty()) return std::nullopt;
  Xxh64Stream hash;
  hash.update(std::as_bytes(std::span(quanta_)));
  std::uint32_t before = std::numeric_limits<std::uint32_t>::max();
  for (const Run& run : runs_) {
    if (run.number == before) continue;
    before = run.number;
    const std::array<std::uint64_t, 2> numbers{run.first, run.number};
    hash.update(std::as_bytes(std::span(numbers)));
  }
  out.hash = hash.digest();
  return out;
}

void OriginTable::warn(const StoreOrigins& origins, std::uint64_t points,
                       const std::optional<Box>& box, double metres, MessageLog& log) const {
  if (origins.points_without > 0) {
    const double share = percentage(origins.points_without, points);
    log.warn("points-without-origin",
             format_count(origins.points_without) + " of " + format_count(points) + " points (" +
                 format_brief(share) +
                 " %) have no origin, so it is not known where the space before them was seen from",
             {{"points", origins.points_without}, {"share", share / 100}});
  }
  if (all_zero_) warn_of_zero(box, metres, log);
  if (box && metres > 0) warn_of_far(origins, *box, metres, log);
}

void OriginTable::warn_of_zero(const std::optional<Box>& box, double metres,
                               MessageLog& log) const {
  const double away = box ? metres * distance(*box, {0, 0, 0}) : 0;
  if (with_origin_ < 2 && away <= kNearMetres) return;
  const std::string why =
      away > kNearMetres
          ? "but all points are more than " + format_brief(away) + " m away from there"
          : "but they were given for " + format_count(with_origin_) + " scans or parts of one";
  log.warn("origins-at-zero",
           "all origins are at 0 0 0, " + why +
               ". That is right for a single scan in its scanner's own coordinates, and wrong for "
               "scans that were moved or merged without their positions",
           {{"runs", with_origin_}, {"metres", away}});
}

void OriginTable::warn_of_far(const StoreOrigins& origins, const Box& box, double metres,
                              MessageLog& log) const {
  std::uint64_t far = 0;
  double farthest = 0;
  Vec3 at{};
  for (const OriginQuanta& q : origins.quanta) {
    Vec3 origin{};
    for (int k = 0; k < 3; ++k) {
      origin[k] = static_cast<double>(q[static_cast<std::size_t>(k)]) * quantisation_.scale[k] +
                  quantisation_.offset[k];
    }
    const double away = metres * distance(box, origin);
    if (away > kFarMetres) ++far;
    if (away > farthest) at = origin;
    farthest = std::max(farthest, away);
  }
  if (far == 0) return;
  log.add(warning("origins-far", {{"origins", far}, {"metres", farthest}},
                  "{} of {}{} more than 1 km away from all points; the farthest, {}, by {} km. Are "
                  "they in the coordinates of the scans?",
                  format_count(far), counted(origins.quanta.size(), "origin"),
                  far == 1 ? " is" : " are", text_of(at), format_brief(farthest / 1000)));
}

void add_origins_of_inputs(const EnvironmentSource& environment, OriginTable& table) {
  std::uint64_t first = 0;
  for (std::size_t file = 0; file < environment.files().size(); ++file) {
    const CloudInfo& info = environment.infos()[file];
    const std::uint64_t points = environment.points_of_files()[file];
    if (points == 0) continue;
    const std::string name = environment.files()[file].string();
    if (info.origins.empty()) table.add(first, std::nullopt, name);
    if (!info.origins.empty()) table.rest_on(info.origins_rest_on);
    for (const OriginRun& run : info.origins) {
      if (run.first < points) table.add(first + run.first, run.origin, name);
    }
    first += points;
  }
  if (first == 0) table.add(0, std::nullopt, "");
}

}  // namespace clearway

// Files of origins.

namespace clearway {
namespace {

/// Calls `use(table, first, origin)` for each row of a file of origins, whose form is checked.
template <typename Use>
void for_each_origin(const std::filesystem::path& path, Use use) {
  constexpr std::string_view kColumns[] = {"first", "x", "y", "z"};
  TextTable table(InputBuffer::open_regular(path), ',');
  if (!table.next()) refuse(table.name(), "is empty; expected the line first,x,y,z first");
  if (!table.is_header(kColumns)) {
    table.refuse_here(excerpt(table.line()) + "; expected the header first,x,y,z");
  }
  std::array<TextColumn, 4> columns;
  for (std::size_t i = 0; i < 4; ++i) columns[i] = *table.column(kColumns[i]);
  std::optional<std::uint64_t> before;
  while (table.next()) {
    table.take_row(std::numeric_limits<std::size_t>::max(), "origins");
    const auto first = parse_count(table.text(columns[0]));
    if (!first) {
      table.refuse_here(excerpt(table.text(columns[0])) +
                        "; expected a source index, a whole number from 0");
    }
    const Vec3 origin{table.number(columns[1]), table.number(columns[2]), table.number(columns[3])};
    if (!before && *first != 0) {
      table.refuse_here("starts at source index " + std::to_string(*first) + "; expected 0");
    }
    if (before && *first <= *before) {
      table.refuse_here("source index " + std::to_string(*first) + " after " +
                        std::to_string(*before) + "; expected ascending ones");
    }
    if (!table.input().line_terminated()) {
      table.refuse_here(
          "ends without a line break, so that its last number may be cut off; expected one");
    }
    before = first;
    use(table, *first, origin);
  }
  if (!before) refuse(table.name(), "holds no origin; expected one at least");
}

}  // namespace

void add_origins_of_file(const std::filesystem::path& path, OriginTable& table) {
  table.rest_on("a file of origins");
  for_each_origin(path, [&](const TextTable& from, std::uint64_t first, const Vec3& origin) {
    table.add(first, origin, from.name());
  });
}

void refuse_origins_beyond(const std::filesystem::path& path, std::uint64_t input_points) {
  for_each_origin(path, [&](const TextTable& from, std::uint64_t first, const Vec3&) {
    if (first == 0 || first < input_points) return;
    from.refuse_here("starts at source index " + std::to_string(first) + ", but the inputs have " +
                     std::to_string(input_points) + " points; is it the file of other scans?");
  });
}

}  // namespace clearway
