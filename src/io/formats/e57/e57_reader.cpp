#include "io/formats/e57/e57_reader.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "io/formats/e57/e57_header.hpp"
#include "io/formats/e57/e57_remarks.hpp"
#include "io/formats/e57/e57_scan_reader.hpp"
#include "io/formats/wkt.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

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
                  scan.name() + " has " + std::to_string(scan.records) +
                      " records that take no byte; expected at most " +
                      std::to_string(PointReader::kBatchPoints) + " of them in a file");
    }
    records += scan.records;
  }
}

Message foot_warning(const std::string& name) {
  return {Message::Severity::kWarning, "e57-unit",
          name +
              ": its coordinate reference system is in feet, but lengths in E57 are metres by the "
              "standard. They are taken for feet: check them"};
}

class E57Reader final : public PointReader {
 public:
  explicit E57Reader(E57Container file) : pages_(std::move(file.pages)) {}

  void open(E57Document document) {
    scans_ = std::move(document.scans);
    std::uint64_t points = 0;
    for (const E57Scan& scan : scans_) {
      extents_.push_back(find_e57_section(pages_, scan));
      if (scan.has_coordinates()) points += scan.records;
    }
    refuse_shared_sections(pages_.name(), scans_, extents_);
    refuse_points_from_nothing(pages_.name(), scans_);
    info_.declared_points = points;
    info_.crs_wkt = std::move(document.crs);
    const CrsUnits units = units_of_wkt(info_.crs_wkt);
    info_.unit = units.horizontal;
    info_.unit_trouble = units.trouble;
    if (info_.unit == LengthUnit::kUnknown) info_.unit = LengthUnit::kMetre;
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.quanta.clear();
    batch.positions.clear();
    batch.absent.clear();
    for (; scan_ < scans_.size(); ++scan_, reader_.reset()) {
      if (!scans_[scan_].has_coordinates()) {
        note_unread(scans_[scan_]);
        continue;
      }
      if (!reader_)
        reader_ = std::make_unique<E57ScanReader>(pages_, scans_[scan_], extents_[scan_]);
      if (reader_->read(batch)) return true;
      remarks_.add(scans_[scan_], reader_->findings());
    }
    info_.remarks = remarks_.messages(pages_.name());
    if (info_.unit == LengthUnit::kFoot || info_.unit == LengthUnit::kUsSurveyFoot) {
      info_.remarks.push_back(foot_warning(pages_.name()));
    }
    return false;
  }

  void rewind() override {
    scan_ = 0;
    reader_.reset();
    remarks_ = {};
  }

 private:
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
  E57Remarks remarks_;
  std::size_t scan_ = 0;
  std::unique_ptr<E57ScanReader> reader_;  ///< reader of scans_[scan_]; null before its first point
};

}  // namespace

std::unique_ptr<PointReader> read_e57(File file) {
  E57Container container = open_e57(std::move(file));
  E57Document document = read_e57_document(container);
  auto reader = std::make_unique<E57Reader>(std::move(container));
  reader->open(std::move(document));
  return reader;
}

}  // namespace clearway
