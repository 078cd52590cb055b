#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "clearway/clearway.hpp"
#include "findings/searched_scene.hpp"
#include "io/files/input_error.hpp"
#include "support/bytes/las_bytes.hpp"
#include "support/store_fixture.hpp"

/// Scans of a road at several epochs, and the ledger of the conflicts of a vehicle that drives
/// along it.
namespace clearway::test {

/// The points of a scan, with what LAS says of them.
struct RoadScan {
  std::vector<Quantum> points;
  std::vector<std::uint8_t> classes, flags;
  std::uint16_t year = 0;  ///< year in the file's header; 0: none

  RoadScan& add(const std::vector<Vec3>& more, std::uint8_t point_class = 1,
                bool withheld = false) {
    for (const Vec3& p : more) points.push_back(millimetres(p));
    classes.resize(points.size(), point_class);
    flags.resize(points.size(), withheld ? 4 : 0);
    return *this;
  }

  void write(const std::filesystem::path& path) const {
    LasBytes las;
    las.minor = 4;
    las.format = 6;
    las.scale = {0.001, 0.001, 0.001};
    las.offset = {0, 0, 0};
    las.points = points;
    las.bytes_of_class = classes;
    las.bytes_of_flags = flags;
    std::string bytes = las.build();
    LasBytes::put(bytes, 90, static_cast<std::uint16_t>(year > 0 ? 100 : 0));
    LasBytes::put(bytes, 92, year);
    put_bytes(path, bytes);
  }
};

/// A grid of points beside the way: from `from` on along the path, at `left`, 1 to 2 m high.
inline std::vector<Vec3> panel(double from, double left, double length = 1, double step = 0.05) {
  std::vector<Vec3> out;
  for (int i = 0; i * step <= length + 1e-9; ++i) {
    for (int k = 0; k * step <= 1 + 1e-9; ++k) {
      out.push_back({from + i * step, left, 1 + k * step});
    }
  }
  return out;
}

/// A road of 30 m with a wall on either side, where nothing collides, up to `end` along the path.
inline RoadScan road(double end = 26) {
  std::vector<Vec3> out;
  for (double x = -4; x <= end; x += 0.2) {
    for (double y = -2; y <= 2.01; y += 0.2) out.push_back({x, y, 0});
    for (double z = 0.2; z <= 3.01; z += 0.2) {
      out.push_back({x, -1.8, z});
      out.push_back({x, 1.8, z});
    }
  }
  return RoadScan().add(out);
}

/// What is asked of a scan.
struct RoadQuestion {
  Query query;
  bool knows_store = true, knows_model = true;
  double worse_by = 0.02;
  std::string date = "2026-06-30";

  RoadQuestion() {
    // Steps of the radius, so that nothing between two poses could be missed
    query = solid_box({{-2, -1, 0.2}, {2, 1, 3}}, {}, 0.1);
    for (int i = 0; i <= 200; ++i) query.poses.push_back(translation({0.1 * i, 0, 0}));
    query.first_pose = true;
    query.clearance = 0.3;
  }
};

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// A ledger with the scans that it is kept of.
struct LedgerScene {
  std::filesystem::path table() const { return folder / "L.csv"; }
  std::filesystem::path places() const { return folder / "L.places.h5"; }
  /// Where scanners stood in all scans; there are none as long as the file is not there.
  std::filesystem::path origins() const { return folder / "origins.csv"; }
  std::string text() const { return text_of_file(table()); }
  void write(const std::string& text) const { write_text(table(), text); }

  /// Searches a scan, and judges its conflicts by the ledger.
  Ledger run(const RoadScan& scan, const RoadQuestion& asked, bool update = true) {
    const std::string name = "scan" + std::to_string(epoch_++);
    scan.write(folder / (name + ".las"));
    ConvertOptions conversion{.cell_points = 256, .threads = 2};
    if (std::filesystem::exists(origins())) conversion.origins = origins();
    convert({folder / (name + ".las")}, folder / (name + ".h5"), conversion);
    const Store store(folder / (name + ".h5"));
    const auto output = folder / (name + ".result.h5");
    search(store, asked.query, output, {.device = Device::kCpu, .threads = 2});
    const Result result(output);
    const ConflictOptions find{.model = asked.knows_model ? &asked.query.model : nullptr,
                               .threads = 2};
    std::vector<std::uint32_t> conflict_of, conflict_of_near;
    const Conflicts conflicts =
        find_conflicts(result, asked.query.poses, find, &conflict_of, &conflict_of_near);
    return apply_ledger({result, conflicts, conflict_of, conflict_of_near, asked.query.poses}, find,
                        {.table = table(),
                         .update = update,
                         .worse_by = asked.worse_by,
                         .date = asked.date,
                         .store = asked.knows_store ? &store : nullptr,
                         .threads = 2});
  }

  /// Sets the cells of a column in all rows, or in one.
  void set(const std::string& column, const std::string& value, int row = -1) const {
    std::istringstream lines(text());
    std::string out;
    std::ptrdiff_t index = 0;
    int number = -1;
    for (std::string line; std::getline(lines, line); ++number) {
      std::istringstream cells(line + ",");
      std::ptrdiff_t at = 0;
      for (std::string cell; std::getline(cells, cell, ','); ++at) {
        if (number < 0 && cell == column) index = at;
        const bool is_set = number >= 0 && at == index && (row < 0 || row == number);
        out += (at > 0 ? "," : "") + (is_set ? value : cell);
      }
      out += "\n";
    }
    write(out);
  }

  ScratchFolder folder;

 private:
  int epoch_ = 0;
};

/// The counts that are not 0, as in "open 1, accepted 2".
inline std::string counts_of(const Ledger& ledger) {
  std::string out;
  const auto counts = ledger.counts();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    if (!out.empty()) out += ", ";
    out += name_of(static_cast<LedgerStatus>(i)) + std::string(" ") + std::to_string(counts[i]);
  }
  return out;
}

/// The reasons of all rows, for messages.
inline std::string reasons_of(const Ledger& ledger) {
  std::string out;
  for (const LedgerRow& row : ledger.rows) out += row.key + ": " + row.why + "; ";
  return out;
}

}  // namespace clearway::test
