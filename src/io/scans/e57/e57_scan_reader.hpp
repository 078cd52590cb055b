#pragma once

#include <cstdint>
#include <memory>

#include "io/scans/cut_off.hpp"
#include "io/scans/declared_box.hpp"
#include "io/scans/e57/e57_document.hpp"
#include "io/scans/e57/e57_file.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Logical positions of a scan's binary section.
struct E57Extent {
  std::uint64_t start = 0;
  std::uint64_t packets = 0;  ///< start of the first packet
  std::uint64_t end = 0;
};

/// Reads the header of a scan's binary section. Compares it with the file and with the scan's
/// number of records, for which the packets must have room. A scan without records may lack a
/// section; its extent is empty. Throws InputError.
E57Extent find_e57_section(E57Pages& pages, const E57Scan& scan);

/// Findings in a scan's records, complete once the scan has been read.
struct E57Findings {
  std::uint64_t absent = 0;  ///< records without a valid point
  /// The finite points against the declared bounds, without the pose and with it. Empty where there
  /// are no bounds, and `posed` where there is no pose.
  BoundsWarnings::Found own, posed;
  CutOff cut_off;  ///< points at the ends of fields of 32-bit integers
};

/// Reads the points of one scan and applies its pose.
class E57ScanReader {
 public:
  virtual ~E57ScanReader() = default;
  /// Appends points until the batch has PointReader::kBatchPoints. Returns false, with nothing
  /// appended, once all are read and the section has been compared with the scan's number of
  /// records.
  virtual bool read(PointBatch& batch) = 0;
  const E57Findings& findings() const { return findings_; }

 protected:
  E57Findings findings_;
};

/// Makes the reader of a scan that has coordinates. The arguments must outlive it.
std::unique_ptr<E57ScanReader> make_e57_scan_reader(E57Pages& pages, const E57Scan& scan,
                                                    const E57Extent& extent);

}  // namespace clearway
