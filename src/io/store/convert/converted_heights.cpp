#include "io/store/convert/converted_heights.hpp"

#include <utility>

namespace clearway {

void convert_heights(CloudInfo& info, double factor) {
  if (info.quantisation) {
    info.quantisation->scale[2] *= factor;
    info.quantisation->offset[2] *= factor;
  }
  if (info.declared_box) {
    info.declared_box->lo.z *= factor;
    info.declared_box->hi.z *= factor;
  }
  for (OriginRun& run : info.origins) {
    if (run.origin) run.origin->z *= factor;
  }
}

namespace {

class ConvertedHeights final : public PointReader {
 public:
  ConvertedHeights(std::shared_ptr<PointReader> reader, double factor)
      : reader_(std::move(reader)), factor_(factor) {
    take_info();
  }

  const CloudInfo& info() const override { return info_; }

  bool read(PointBatch& batch) override {
    const bool more = reader_->read(batch);
    if (!more) take_info();
    convert(batch);
    return more;
  }

  std::size_t pieces() const override { return reader_->pieces(); }
  std::uint64_t points_of_piece(std::size_t piece) const override {
    return reader_->points_of_piece(piece);
  }
  void read_piece(std::size_t piece, PointBatch& batch, PieceBytes* bytes) override {
    reader_->read_piece(piece, batch, bytes);
    convert(batch);
  }
  std::optional<Box> bounds_of_piece(std::size_t piece) const override {
    std::optional<Box> box = reader_->bounds_of_piece(piece);
    if (box) {
      box->lo.z *= factor_;
      box->hi.z *= factor_;
    }
    return box;
  }
  PieceBytes place_of_piece(std::size_t piece) const override {
    return reader_->place_of_piece(piece);
  }
  bool can_rewind() const override { return reader_->can_rewind(); }
  void rewind() override { reader_->rewind(); }
  std::vector<std::uint64_t> lines_of(std::span<const std::uint64_t> points) override {
    return reader_->lines_of(points);
  }

 private:
  void take_info() {
    info_ = reader_->info();
    convert_heights(info_, factor_);
  }

  void convert(PointBatch& batch) const {
    for (Vec3& position : batch.positions) position.z *= factor_;
  }

  std::shared_ptr<PointReader> reader_;
  double factor_;
  CloudInfo info_;
};

}  // namespace

std::shared_ptr<PointReader> with_converted_heights(std::shared_ptr<PointReader> reader,
                                                    double factor) {
  return std::make_shared<ConvertedHeights>(std::move(reader), factor);
}

}  // namespace clearway
