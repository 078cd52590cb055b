#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "io/scans/input_buffer.hpp"
#include "io/scans/pcd/pcd_header.hpp"
#include "io/scans/point_reader.hpp"

namespace clearway {

/// Base of the readers of the three kinds of PCD file.
class PcdBodyReader : public PointReader {
 public:
  const CloudInfo& info() const override { return info_; }
  bool read(PointBatch& batch) override;
  void rewind() override;

 protected:
  /// input: stands after the line DATA.
  PcdBodyReader(InputBuffer input, PcdHeader header);

  /// Reads the next points, in order; header_.points in all.
  virtual void read_points(std::span<Vec3> out) = 0;
  virtual void start_again() = 0;
  /// Called with the input after the last point. Throws InputError where the file does not end
  /// there.
  virtual void check_end() = 0;

  /// Throws InputError for anything after binary data except what PCL leaves there: up to a page
  /// of zeros, or a line break.
  void check_only_padding();

  InputBuffer input_;
  PcdHeader header_;
  CloudInfo info_;
  InputBuffer::Mark first_point_;
  std::uint64_t next_ = 0;  ///< index of the point to read next

 private:
  void mark_absent(PointBatch& batch);
  void finish();

  bool finished_ = false;
};

std::unique_ptr<PointReader> read_ascii_pcd(InputBuffer input, PcdHeader header);
std::unique_ptr<PointReader> read_binary_pcd(InputBuffer input, PcdHeader header);
std::unique_ptr<PointReader> read_compressed_pcd(InputBuffer input, PcdHeader header);

/// Reads PCD files with ascii, binary and binary_compressed data. Points are in the frame of the
/// file's x, y and z. A VIEWPOINT other than the default is not applied, because PCL defines it as
/// where the points were acquired from, and a remark says so. In an organised cloud (HEIGHT above
/// 1) a point with NaN is absent. The input must be able to seek.
std::unique_ptr<PointReader> read_pcd(InputBuffer input);

}  // namespace clearway
