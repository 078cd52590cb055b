#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "clearway/error.hpp"
#include "io/store/convert/convert.hpp"
#include "io/store/store_reader.hpp"
#include "support/scratch_folder.hpp"

/// Scans made for a test, their conversion, and what the store then holds.
namespace clearway::test {

using Quantum = std::array<std::int32_t, 3>;

inline const Quantisation kMillimetres{{0.001, 0.001, 0.001}, {100, -200, 0}};

void write_las(const std::filesystem::path& path, std::span<const Quantum> points,
               const Quantisation& quantisation = kMillimetres);

void write_ply(const std::filesystem::path& path, std::span<const Vec3> points);

ConversionOptions conversion_of(std::vector<std::filesystem::path> inputs,
                                const std::filesystem::path& output,
                                std::uint32_t cell_points = 64);

ConversionReport convert_quietly(const ConversionOptions& options);

/// The message with which the conversion is refused; empty where it succeeds.
template <typename Refusal = Error>
std::string conversion_refusal(const ConversionOptions& options) {
  try {
    convert_quietly(options);
  } catch (const Refusal& error) {
    return error.what();
  }
  return {};
}

/// Whether the store that these options make is there already.
bool is_converted_by(const ConversionOptions& options);

/// Scans in a folder of their own, and the options of their conversion to the store a.h5 in it.
struct Conversion {
  explicit Conversion(std::uint32_t cell_points = 64)
      : options(conversion_of({}, folder / "a.h5", cell_points)) {}

  /// Writes a file, in place of an old one of this name, and makes it an input.
  void add(const std::string& name, const std::string& bytes);
  void add_las(const std::string& name, std::span<const Quantum> points,
               const Quantisation& quantisation = kMillimetres);
  void add_ply(const std::string& name, std::span<const Vec3> points);

  ConversionReport convert() const { return convert_quietly(options); }
  std::string converted_bytes() const;
  /// Converts, and opens the store, in which no fault may be found.
  StoreReader store() const;
  /// The message with which the conversion is refused; empty where it is not.
  template <typename Refusal = InputError>
  std::string refusal() const {
    return conversion_refusal<Refusal>(options);
  }

  ScratchFolder folder;
  ConversionOptions options;

 private:
  void add_input(const std::filesystem::path& path);
};

/// Calls `begun` when a stage of a conversion begins, and stops after `advances` of that stage.
class WatchedStage final : public Progress {
 public:
  explicit WatchedStage(std::string stage, std::function<void()> begun, int advances = 1 << 30)
      : stage_(std::move(stage)), begun_(std::move(begun)), left_(advances) {}

  void begin(std::string_view stage, std::uint64_t, std::string_view) override {
    in_stage_ = stage == stage_;
    if (in_stage_) begun_();
  }
  void advance(std::uint64_t) override { left_ -= in_stage_ ? 1 : 0; }
  void end() override { in_stage_ = false; }
  bool stop_requested() const override { return left_ <= 0; }

 private:
  std::string stage_;
  std::function<void()> begun_;
  std::atomic<int> left_;
  bool in_stage_ = false;
};

/// The number of this name in a message; fails where there is none.
double number_of(const Message& message, std::string_view name);

/// The classes of a store's points, by source index.
std::vector<std::uint8_t> classes_by_source(const StoreReader& store);

using OriginQuanta = std::array<std::int64_t, 3>;

/// The origins of a store's points, by source index; nullopt for points without one.
std::vector<std::optional<OriginQuanta>> origins_by_source(const StoreReader& store);

struct StoredPoint {
  std::uint64_t source;
  Quantum q;
  friend bool operator==(const StoredPoint&, const StoredPoint&) = default;
};

/// The points of cells first .. first + count - 1 in the store's order.
std::vector<StoredPoint> points_of_cells(const StoreReader& store, std::uint32_t first,
                                         std::uint32_t count);

std::vector<StoredPoint> stored_points(const StoreReader& store);

/// The store's points in source order. Throws where a source index is missing, out of range or
/// there twice.
std::vector<Quantum> points_by_source(const StoreReader& store);

std::vector<std::string> faults_of(const StoreReader& store);

}  // namespace clearway::test
