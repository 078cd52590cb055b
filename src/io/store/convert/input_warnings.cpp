#include "io/store/convert/input_warnings.hpp"

#include "clearway/error.hpp"
#include "core/util/format.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/store/convert/same_scans.hpp"

namespace clearway {

namespace {

// Greatest share of withheld points that causes no more than a note.
constexpr double kMostWithheld = 0.01;
constexpr double kMostAbsent = 0.99;  // greatest share of absent records that is not reported

/// A share as a percentage: "12.3 %".
std::string percentage(double share) { return format_brief(100 * share) + " %"; }

/// A point in words: "point 7 (counted from 0) of a.las".
std::string name_of(const EnvironmentSource& environment, std::uint64_t source) {
  const EnvironmentSource::Place place = environment.place_of(source);
  return "point " + format_count(place.point) + " (counted from 0) of " +
         environment.files()[place.file].string();
}

void warn_of_missing(const EnvironmentSource& environment, const StoreMetadata& metadata,
                     MessageLog& log) {
  const auto records = static_cast<double>(metadata.input_points);
  const auto non_finite = static_cast<double>(environment.counts().non_finite_points);
  const auto absent = static_cast<double>(environment.counts().absent_points);
  if (non_finite > 0) {
    log.add(warning("non-finite-points", {{"points", non_finite}, {"share", non_finite / records}},
                    "{} points ({}) with NaN or infinite coordinates are left out; the first is {}",
                    format_count(environment.counts().non_finite_points),
                    percentage(non_finite / records),
                    name_of(environment, environment.counts().first_non_finite)));
  }
  const auto withheld = static_cast<double>(environment.counts().withheld_points);
  if (withheld > 0) {
    const bool kept = metadata.withheld && metadata.withheld->kept;
    log.add(warning_or_note(
        !kept && withheld > kMostWithheld * records, "withheld-points",
        format_count(environment.counts().withheld_points) + " of " +
            format_count(metadata.input_points) + " points (" + percentage(withheld / records) +
            ") have the flag `withheld` and are " +
            (kept ? "kept; the first is " : "left out as deleted; the first is ") +
            name_of(environment, environment.counts().first_withheld),
        {{"points", withheld}, {"share", withheld / records}, {"kept", kept ? 1.0 : 0.0}}));
  }
  if (absent > kMostAbsent * records && metadata.point_count > 0) {
    log.add(warning("absent-points", {{"records", absent}, {"share", absent / records}},
                    "{} of {} records ({}) hold no point",
                    format_count(environment.counts().absent_points),
                    format_count(metadata.input_points), percentage(absent / records)));
  }
}

}  // namespace

std::optional<Box> warn_of_inputs(const EnvironmentSource& environment, const FileBoxes& boxes,
                                  const StoreMetadata& metadata, MessageLog& log) {
  const auto& files = environment.files();
  const std::vector<FileBox> of_files = boxes.boxes(files.size());
  for (Message& remark : environment.remarks()) log.add(std::move(remark));
  warn_of_missing(environment, metadata, log);
  warn_of_boxes(of_files, metadata.quantisation, files, environment.infos(), log);
  warn_of_same_scans(files, metadata.sources, of_files, log);
  return common_box(of_files, metadata.quantisation);
}

void warn_of_places(const EnvironmentSource& environment, const PlaceCounter& places,
                    std::uint64_t points, MessageLog& log) {
  const std::vector<PlaceCounter::Place> crowded = places.crowded(points);
  if (crowded.empty()) return;
  const PlaceCounter::Place& most = crowded[0];
  const double share = static_cast<double>(most.count) / static_cast<double>(points);
  const Vec3 at = position(environment.quantisation(), most.at[0], most.at[1], most.at[2]);
  const bool zeros = environment.origin_of(environment.place_of(most.first).file) == most.at;
  std::string text = format_count(most.count) + " of " + format_count(points) + " points (" +
                     percentage(share) + ") are at one place, " + format_digits(at.x, 9) + " " +
                     format_digits(at.y, 9) + " " + format_digits(at.z, 9) + ", from " +
                     name_of(environment, most.first) + " to " + name_of(environment, most.last);
  if (zeros) text += ". These are zeros in the file: a file copied by half reads so";
  if (crowded.size() > 1) {
    text += ". " + std::to_string(crowded.size() - 1) + " more such places hold fewer points";
  }
  log.warn("same-place", text,
           {{"points", most.count},
            {"share", share},
            {"x", at.x},
            {"y", at.y},
            {"z", at.z},
            {"places", crowded.size()}});
}

}  // namespace clearway
