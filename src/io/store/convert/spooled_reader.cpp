#include "io/store/convert/spooled_reader.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/files/file.hpp"

namespace clearway {
namespace {

class SpooledReader final : public PointReader {
 public:
  SpooledReader(std::unique_ptr<PointReader> stream, const std::filesystem::path& folder)
      : info_(stream->info()),
        stream_(std::move(stream)),
        file_(File::create_temporary(folder)),
        classes_(File::create_temporary(folder)),
        flags_(File::create_temporary(folder)),
        times_(File::create_temporary(folder)) {}

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override { return stream_ ? read_stream(batch) : read_spool(batch); }

  void rewind() override {
    if (stream_ && spooled_ > 0) throw std::logic_error("rewound before the stream's end");
    next_ = 0;
  }

 private:
  using Quanta = std::array<std::int32_t, 3>;

  bool read_stream(PointBatch& batch) {
    if (!stream_->read(batch)) {
      info_ = stream_->info();  // a CRS after the points is known now
      stream_.reset();
      next_ = spooled_;
      return false;
    }
    file_.write(std::as_bytes(std::span(batch.quanta)));
    classes_.write(std::as_bytes(std::span(batch.classes)));
    flags_.write(std::as_bytes(std::span(batch.flags)));
    times_.write(std::as_bytes(std::span(batch.times)));
    has_flags_ = has_flags_ || !batch.flags.empty();
    has_times_ = has_times_ || !batch.times.empty();
    spooled_ += batch.quanta.size();
    return true;
  }

  bool read_spool(PointBatch& batch) {
    batch.positions.clear();
    batch.quanta.resize(std::min<std::uint64_t>(kBatchPoints, spooled_ - next_));
    file_.read_at(next_ * sizeof(Quanta), std::as_writable_bytes(std::span(batch.quanta)));
    batch.classes.resize(batch.quanta.size());
    classes_.read_at(next_, std::as_writable_bytes(std::span(batch.classes)));
    batch.flags.resize(has_flags_ ? batch.quanta.size() : 0);
    flags_.read_at(next_, std::as_writable_bytes(std::span(batch.flags)));
    batch.times.resize(has_times_ ? batch.quanta.size() : 0);
    times_.read_at(next_ * sizeof(double), std::as_writable_bytes(std::span(batch.times)));
    next_ += batch.quanta.size();
    return !batch.quanta.empty();
  }

  CloudInfo info_;
  std::unique_ptr<PointReader> stream_;  // null once read to its end
  File file_;
  File classes_;  ///< one byte per point; streams are LAS, which has classes
  File flags_;    ///< the flags of each point, where the stream has them
  File times_;    ///< the GPS time of each point, where the stream was asked for them
  bool has_flags_ = false, has_times_ = false;
  std::uint64_t spooled_ = 0;
  std::uint64_t next_ = 0;
};

}  // namespace

std::unique_ptr<PointReader> spool(std::unique_ptr<PointReader> stream,
                                   const std::filesystem::path& folder) {
  return std::make_unique<SpooledReader>(std::move(stream), folder);
}

}  // namespace clearway
