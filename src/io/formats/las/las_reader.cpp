#include "io/formats/las/las_reader.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "io/formats/las/las_header.hpp"
#include "io/system/input_error.hpp"

namespace clearway {
namespace {

class LasReader final : public PointReader {
 public:
  explicit LasReader(InputBuffer input)
      : input_(std::move(input)), header_(read_las_header(input_)) {
    read_las_vlrs(input_, header_, crs_);
    first_point_ = input_.mark();
    if (input_.can_seek()) {
      read_las_tail(input_, header_, crs_);
      input_.return_to(first_point_);
      tail_read_ = true;
    }
    info_.quantisation = header_.quantisation;
    info_.declared_points = header_.points;
    crs_.describe(info_);
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    batch.positions.clear();
    const std::size_t count = std::min<std::uint64_t>(kBatchPoints, header_.points - next_);
    batch.quanta.resize(count);
    const std::size_t most = InputBuffer::kCapacity / header_.record_bytes;
    for (std::size_t done = 0; done < count;) {
      const std::size_t records = std::min(most, count - done);
      decode(take_records(records), batch.quanta.data() + done);
      done += records;
      next_ += records;
    }
    if (count == 0) finish();
    return count > 0;
  }

  void rewind() override {
    input_.return_to(first_point_);
    next_ = 0;
  }

 private:
  std::span<const std::byte> take_records(std::size_t records) {
    const auto bytes = input_.take(records * header_.record_bytes);
    if (!bytes.empty()) return bytes;
    const std::uint64_t end = input_.end_position();
    refuse(input_.name(), "ends at byte " + std::to_string(end) + ", within point " +
                              std::to_string((end - header_.points_offset) / header_.record_bytes) +
                              " of " + std::to_string(header_.points) + "; expected " +
                              std::to_string(header_.points_end()) + " bytes");
  }

  void decode(std::span<const std::byte> bytes, std::array<std::int32_t, 3>* out) const {
    const std::size_t stride = header_.record_bytes;
    const std::byte* record = bytes.data();
    const std::byte* const end = record + bytes.size();
    for (; record != end; record += stride) std::memcpy(out++, record, sizeof *out);
  }

  void finish() {
    if (tail_read_) return;
    read_las_tail(input_, header_, crs_);
    crs_.describe(info_);
    tail_read_ = true;
  }

  InputBuffer input_;
  LasPublicHeader header_;
  LasCrs crs_;
  CloudInfo info_;
  InputBuffer::Mark first_point_;
  std::uint64_t next_ = 0;  ///< point to read next
  bool tail_read_ = false;
};

}  // namespace

std::unique_ptr<PointReader> read_las(InputBuffer input) {
  return std::make_unique<LasReader>(std::move(input));
}

std::unique_ptr<PointReader> open_las_stream(File stream) {
  return read_las(InputBuffer(std::move(stream), InputBuffer::Access::kStream));
}

}  // namespace clearway
