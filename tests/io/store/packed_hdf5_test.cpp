// Our packed chunks against HDF5's own scale-offset filter, byte for byte.
#include <hdf5.h>

#include <array>
#include <string>

#include "io/files/hdf5.hpp"
#include "support/catch.hpp"
#include "support/packed_values.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

/// A file in memory with datasets like those of /points.
class PackedFile {
 public:
  PackedFile() {
    const hdf5::Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "access list");
    hdf5::check(H5Pset_fapl_core(access.get(), 1 << 16, false), "file in memory");
    file_ = {H5Fcreate("packed", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose, "file"};
  }

  /// Makes a dataset of one chunk of `count` values.
  template <typename Value>
  hdf5::Id dataset(std::size_t count) {
    const std::array<hsize_t, 2> size{1, count};
    const hdf5::Id space(H5Screate_simple(2, size.data(), nullptr), H5Sclose, "space");
    const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "list");
    const hid_t type = hdf5::file_type<Value>();
    hdf5::check(H5Pset_chunk(list.get(), 2, size.data()), "chunk");
    hdf5::check(H5Pset_fill_value(list.get(), type, nullptr), "fill value");
    hdf5::check(H5Pset_fill_time(list.get(), H5D_FILL_TIME_NEVER), "fill time");
    hdf5::check(H5Pset_scaleoffset(list.get(), H5Z_SO_INT, H5Z_SO_INT_MINBITS_DEFAULT), "filter");
    const std::string name = "d" + std::to_string(next_++);
    return {H5Dcreate2(file_.get(), name.c_str(), type, space.get(), H5P_DEFAULT, list.get(),
                       H5P_DEFAULT),
            H5Dclose, "dataset"};
  }

 private:
  hdf5::Id file_;
  unsigned next_ = 0;
};

constexpr std::array<hsize_t, 2> kOrigin{0, 0};

template <typename Value>
std::vector<std::byte> packed_by_hdf5(PackedFile& file, const std::vector<Value>& values) {
  const hdf5::Id dataset = file.dataset<Value>(values.size());
  hdf5::check(H5Dwrite(dataset.get(), hdf5::file_type<Value>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                       values.data()),
              "write");
  hdf5::check(H5Fflush(dataset.get(), H5F_SCOPE_LOCAL), "flush");
  hsize_t size = 0;
  hdf5::check(H5Dget_chunk_storage_size(dataset.get(), kOrigin.data(), &size), "chunk size");
  std::vector<std::byte> bytes(size);
  std::uint32_t mask = 0;
  hdf5::check(H5Dread_chunk(dataset.get(), H5P_DEFAULT, kOrigin.data(), &mask, bytes.data()),
              "read chunk");
  REQUIRE(mask == 0);
  return bytes;
}

template <typename Value>
std::vector<Value> unpacked_by_hdf5(PackedFile& file, const std::vector<std::byte>& bytes,
                                    std::size_t count) {
  const hdf5::Id dataset = file.dataset<Value>(count);
  hdf5::check(
      H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, kOrigin.data(), bytes.size(), bytes.data()),
      "write chunk");
  std::vector<Value> values(count);
  hdf5::check(H5Dread(dataset.get(), hdf5::file_type<Value>(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                      values.data()),
              "read");
  return values;
}

/// Whether the payload's last byte holds no bit, so that HDF5 1.10.8 may leave it uninitialised:
/// the payload has floor(n * minbits / 8) + 1 bytes, so where n * minbits is a multiple of 8 no bit
/// falls into the last.
template <typename Value>
bool last_byte_is_unused(std::size_t count, unsigned minbits) {
  return minbits < kValueBits<Value> && count * minbits % 8 == 0;
}

/// Whether HDF5 reads what it packs itself where values need all their bits.
template <typename Value>
bool reads_full_width(PackedFile& file) {
  const std::vector<Value> values{std::numeric_limits<Value>::min(),
                                  std::numeric_limits<Value>::max()};
  const hdf5::QuietScope quiet;
  try {
    return unpacked_by_hdf5<Value>(file, packed_by_hdf5(file, values), values.size()) == values;
  } catch (const hdf5::CallFailure&) {
    return false;
  }
}

template <typename Value>
void check_against_hdf5(PackedFile& file, const std::vector<Value>& values, unsigned minbits) {
  CAPTURE(values.size(), minbits);
  const auto ours = packed(values);
  auto theirs = packed_by_hdf5(file, values);
  REQUIRE(ours.size() == theirs.size());
  const PackedChunk<Value> chunk(theirs, static_cast<std::uint32_t>(values.size()));
  REQUIRE(chunk.minbits() == minbits);
  std::vector<Value> decoded(values.size());
  chunk.decode(0, decoded);
  REQUIRE(decoded == values);
  if (last_byte_is_unused<Value>(values.size(), minbits)) {
    REQUIRE(ours.back() == std::byte{0});
    theirs.back() = std::byte{0};
  }
  REQUIRE(ours == theirs);
  // HDF5 1.14.5 does not even read what it packs itself where values need all their bits.
  if (minbits == kValueBits<Value> && !reads_full_width<Value>(file)) return;
  REQUIRE(unpacked_by_hdf5<Value>(file, ours, values.size()) == values);
}

}  // namespace

TEMPLATE_TEST_CASE("packed bytes of every width and at its limits are those of HDF5", "",
                   std::int32_t, std::uint64_t, std::uint8_t) {
  using Unsigned = std::make_unsigned_t<TestType>;
  using Limits = std::numeric_limits<TestType>;
  constexpr unsigned kBits = kValueBits<TestType>;
  PackedFile file;
  for (unsigned bits = 0; bits <= kBits; ++bits) {
    const auto span = span_of_bits<TestType>(bits, bits + 1);
    for (const std::size_t count : {2u, 7u, 64u, 1000u}) {
      check_against_hdf5(file, values_of_span<TestType>(count, span, count + bits), bits);
    }
    if (bits < 2 || bits == kBits) continue;
    const auto power = static_cast<Unsigned>(Unsigned{1} << bits);
    const auto less = static_cast<Unsigned>(power - 1);
    check_against_hdf5(file, values_of_span<TestType>(65, less, bits), bits);
    check_against_hdf5(file, values_of_span<TestType>(65, power, bits), bits + 1);
  }
  for (const unsigned below : {0u, 1u, 2u, 3u, 4u}) {
    const auto span = static_cast<Unsigned>(std::numeric_limits<Unsigned>::max() - below);
    check_against_hdf5(file, values_of_span<TestType>(100, span, below), kBits);
  }
  check_against_hdf5<TestType>(file, {Limits::min()}, 0);
  check_against_hdf5<TestType>(file, {Limits::max()}, 0);
}
