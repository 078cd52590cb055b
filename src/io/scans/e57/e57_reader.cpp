#include "io/scans/e57/e57_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "clearway/progress.hpp"
#include "core/util/format.hpp"
#include "io/scans/cut_off.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/e57/e57_file.hpp"
#include "io/scans/e57/e57_scan_reader.hpp"
#include "io/scans/formatted_message.hpp"
#include "io/scans/scan_crs.hpp"

namespace clearway {
namespace {

/// Collects remarks on the scans of a file. Memory does not grow with their number.
class E57Remarks {
 public:
  /// file: the name with which each text begins.
  explicit E57Remarks(std::string file) : file_(std::move(file)) {}

  /// Adds a scan that was read completely.
  void add(const E57Scan& scan, const E57Findings& findings) {
    ++scans_;
    records_ += scan.records;
    absent_ += findings.absent;
    if (scan.records == 0) ++empty_;
    if (scan.pose && scan.records > 0) ++posed_;
    if (scan.is_cartesian()) {
      const auto scale = [&](E57Place place) { return scan.fields[scan.places[place]].scale; };
      cut_off_.add(scan.name(), findings.cut_off, {scale(kE57X), scale(kE57Y), scale(kE57Z)});
    }
    // By the standard, bounds are those of the points before the pose is applied; some writers give
    // those after it.
    if (!scan.bounds) return;
    const bool by_pose = scan.pose && findings.posed.beyond < findings.own.beyond;
    bounds_.add(file_ + ": " + scan.name(), *scan.bounds, by_pose ? findings.posed : findings.own);
  }
  /// Adds a scan that has no coordinates and was not read.
  void add_without_coordinates() { ++scans_, ++without_coordinates_; }

  std::vector<Message> messages() const {
    std::vector<Message> all;
    const auto note = [&](const std::string& text, MessageNumbers numbers) {
      all.push_back(plain_note(file_ + ": " + text, std::move(numbers)));
    };
    const auto scans = [](std::uint64_t count) { return counted(count, "scan"); };
    if (scans_ > 1 || posed_ > 0) {
      note(scans(scans_) + (posed_ == 0   ? "; none has a pose"
                            : posed_ == 1 ? "; 1 pose is applied"
                                          : "; " + format_count(posed_) + " poses are applied"),
           {{"scans", scans_}, {"poses", posed_}});
    }
    if (empty_ > 0) {
      note(scans(empty_) + " without points, of " + format_count(scans_),
           {{"empty_scans", empty_}, {"scans", scans_}});
    }
    if (without_coordinates_ > 0) {
      note(scans(without_coordinates_) + " without coordinates, of " + format_count(scans_) +
               "; their records are not counted",
           {{"scans_without_coordinates", without_coordinates_}, {"scans", scans_}});
    }
    if (absent_ > 0) {
      note(format_count(absent_) + " of " + format_count(records_) + " records have no valid point",
           {{"absent", absent_}, {"records", records_}});
    }
    const std::vector<Message> bounds = bounds_.messages();
    all.insert(all.end(), bounds.begin(), bounds.end());
    if (auto cut_off = cut_off_.message()) {
      cut_off->text.insert(0, file_ + ": ");
      all.push_back(std::move(*cut_off));
    }
    return all;
  }

 private:
  std::string file_;
  std::uint64_t scans_ = 0, posed_ = 0, empty_ = 0, without_coordinates_ = 0;
  std::uint64_t records_ = 0, absent_ = 0;
  BoundsWarnings bounds_;
  CutOffWarning cut_off_;
};

/// Throws InputError where scans share packets, with which a small file could hold any number of
/// points.
void refuse_shared_sections(const std::string& name, const std::vector<E57Scan>& scans,
                            const std::vector<E57Extent>& extents) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (scans[i].records > 0) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(extents[a].start, a) < std::pair(extents[b].start, b);
  });
  for (std::size_t k = 1; k < order.size(); ++k) {
    const std::size_t before = order[k - 1], behind = order[k];
    if (extents[before].end <= extents[behind].start) continue;
    refuse_byte(name, scans[behind].file_offset,
                scans[behind].name() + " shares bytes with " + scans[before].name() +
                    "; expected points of its own");
  }
}

/// Throws InputError where scans whose points take no bytes have more of them than a batch, because
/// a few bytes of XML could declare any number.
void refuse_points_from_nothing(const std::string& name, const std::vector<E57Scan>& scans) {
  std::uint64_t records = 0;
  for (const E57Scan& scan : scans) {
    if (!scan.takes_no_bytes()) continue;
    if (scan.records > PointReader::kBatchPoints - records) {
      refuse_byte(name, scan.file_offset,
                  "{} has {} records that take no byte; expected at most {} of them in a file",
                  scan.name(), scan.records, PointReader::kBatchPoints);
    }
    records += scan.records;
  }
}

Message foot_warning(const std::string& name) {
  return warning("e57-unit",
                 fmt::format("{}: its coordinate reference system is in feet, but lengths in E57 "
                             "are metres by the standard. They are taken for feet: check them",
                             name));
}

class E57Reader final : public PointReader {
 public:
  E57Reader(E57Container file, E57Document document)
      : pages_(std::move(file.pages)), scans_(std::move(document.scans)) {
    std::uint64_t points = 0;
    for (const E57Scan& scan : scans_) {
      extents_.push_back(find_e57_section(pages_, scan));
      if (scan.has_coordinates()) {
        add_origin(scan, points);
        points += scan.records;
      }
    }
    const auto known = [](const OriginRun& run) { return run.origin.has_value(); };
    if (std::none_of(info_.origins.begin(), info_.origins.end(), known)) info_.origins.clear();
    refuse_shared_sections(pages_.name(), scans_, extents_);
    refuse_points_from_nothing(pages_.name(), scans_);
    info_.declared_points = points;
    info_.set(stated_crs_of(crs_text_of(std::as_bytes(std::span(document.crs)))));
    if (info_.unit == LengthUnit::kUnknown) info_.unit = LengthUnit::kMetre;
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.clear();
    for (; scan_ < scans_.size(); ++scan_, reader_.reset()) {
      if (!scans_[scan_].has_coordinates()) {
        note_unread(scans_[scan_]);
        continue;
      }
      if (!reader_) reader_ = make_e57_scan_reader(pages_, scans_[scan_], extents_[scan_]);
      batch.turn = scans_[scan_].pose ? turn_of(*scans_[scan_].pose) : std::nullopt;
      if (reader_->read(batch)) return true;
      remarks_.add(scans_[scan_], reader_->findings());
    }
    info_.remarks = remarks_.messages();
    if (info_.unit == LengthUnit::kFoot || info_.unit == LengthUnit::kUsSurveyFoot) {
      info_.remarks.push_back(foot_warning(pages_.name()));
    }
    return false;
  }

  void rewind() override {
    scan_ = 0;
    reader_.reset();
    remarks_ = E57Remarks(pages_.name());
  }

 private:
  /// Adds where a scan's points were seen from, whose first record has number `first`: from its
  /// pose, or, as spherical coordinates are those of a scanner, from their origin. Cartesian
  /// coordinates without a pose may have been moved, so they do not count.
  void add_origin(const E57Scan& scan, std::uint64_t first) {
    if (scan.records == 0) return;
    std::optional<Vec3> origin;
    if (scan.pose) {
      const double* t = scan.pose->translation;
      origin = Vec3{t[0], t[1], t[2]};
    } else if (scan.is_spherical() && !scan.is_cartesian()) {
      origin = Vec3{0, 0, 0};
    }
    info_.origins.push_back({first, origin});
    info_.origins_rest_on = "poses of E57";
  }

  void note_unread(const E57Scan& scan) {
    if (scan.records == 0) {
      remarks_.add(scan, {});
    } else {
      remarks_.add_without_coordinates();
    }
  }

  E57Pages pages_;
  std::vector<E57Scan> scans_;
  std::vector<E57Extent> extents_;
  CloudInfo info_;
  E57Remarks remarks_{pages_.name()};
  std::size_t scan_ = 0;
  std::unique_ptr<E57ScanReader> reader_;  ///< reader of scans_[scan_]; null before its first point
};

}  // namespace

std::unique_ptr<PointReader> read_e57(File file) {
  E57Container container = open_e57(std::move(file));
  E57Document document = read_e57_document(container);
  return std::make_unique<E57Reader>(std::move(container), std::move(document));
}

}  // namespace clearway
