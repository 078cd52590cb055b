#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "io/formats/input_buffer.hpp"
#include "io/formats/pcd/pcd_header.hpp"
#include "io/formats/point_reader.hpp"

namespace clearway {

/// Base of the readers of the three kinds of PCD file.
class PcdBodyReader : public PointReader {
 public:
  const CloudInfo& info() const override { return info_; }
  bool read(PointBatch& batch) override;
  void rewind() override;

 protected:
  /// input: stands behind the line DATA.
  PcdBodyReader(InputBuffer input, PcdHeader header);

  /// Reads the next points, in order; header_.points in all.
  virtual void read_points(std::span<Vec3> out) = 0;
  virtual void start_again() = 0;
  /// Called with the input behind the last point. Throws InputError where the file does not end
  /// there.
  virtual void check_end() = 0;

  /// Throws InputError for anything behind binary data except what PCL leaves there: up to a page
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

  std::uint64_t absent_ = 0;
  bool finished_ = false;
};

std::unique_ptr<PointReader> read_ascii_pcd(InputBuffer input, PcdHeader header);
std::unique_ptr<PointReader> read_binary_pcd(InputBuffer input, PcdHeader header);
std::unique_ptr<PointReader> read_compressed_pcd(InputBuffer input, PcdHeader header);

}  // namespace clearway
