#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <functional>
#include <tuple>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/hdf5_detail.hpp"

namespace clearway::hdf5 {
namespace {

constexpr hsize_t kChunkBytes = 1 << 18;  // most bytes of a chunk

std::uint64_t rows_of_chunk(std::uint64_t rows, std::uint64_t row_bytes) {
  const std::uint64_t most = std::bit_floor(std::max<std::uint64_t>(1, kChunkBytes / row_bytes));
  return std::min<std::uint64_t>({rows, most, 1 << 16});
}

/// Properties of a dataset that is chunked with fletcher32; an empty dataset has no chunks.
Id checked_layout(std::uint64_t rows, std::uint64_t columns, std::size_t number_bytes) {
  Id list = untimed(H5P_DATASET_CREATE);
  if (rows == 0) return list;
  const std::uint64_t row_bytes = std::max<std::uint64_t>(columns, 1) * number_bytes;
  const std::array<hsize_t, 2> chunk{rows_of_chunk(rows, row_bytes),
                                     std::max<std::uint64_t>(columns, 1)};
  check(H5Pset_chunk(list.get(), columns == 0 ? 1 : 2, chunk.data()), "HDF5 chunk size");
  check(H5Pset_fletcher32(list.get()), "HDF5 fletcher32");
  return list;
}

template <typename Number>
Id create_dataset(const Id& parent, const std::string& name, std::uint64_t rows,
                  std::uint64_t columns) {
  const Id space = simple_space(rows, columns);
  const Id layout = checked_layout(rows, columns, sizeof(Number));
  return {H5Dcreate2(parent.get(), name.c_str(), file_type<Number>(), space.get(), H5P_DEFAULT,
                     layout.get(), H5P_DEFAULT),
          H5Dclose, "create dataset " + name};
}

/// Whether the dataset is stored as checked_layout() says: in this file, in small chunks with
/// a checksum and no other filter, so that its numbers take as many bytes in the file as in memory.
bool has_checked_layout(const Id& dataset, std::uint64_t rows, int dimensions,
                        std::size_t number_bytes) {
  const Id list(H5Dget_create_plist(dataset.get()), H5Pclose, "HDF5 property list");
  if (rows == 0) return H5Pget_layout(list.get()) == H5D_CONTIGUOUS;
  std::array<hsize_t, 2> chunk{1, 1};
  if (H5Pget_layout(list.get()) != H5D_CHUNKED ||
      H5Pget_chunk(list.get(), dimensions, chunk.data()) != dimensions) {
    return false;
  }
  unsigned flags = 0, filter_config = 0;
  std::size_t values = 0;
  const bool checked = H5Pget_nfilters(list.get()) == 1 &&
                       H5Pget_filter2(list.get(), 0, &flags, &values, nullptr, 0, nullptr,
                                      &filter_config) == H5Z_FILTER_FLETCHER32 &&
                       (flags & H5Z_FLAG_OPTIONAL) == 0;
  return checked && chunk[0] <= kChunkBytes && chunk[1] <= kChunkBytes &&
         chunk[0] * chunk[1] * number_bytes <= kChunkBytes;
}

std::uint64_t bytes_of_file(const Id& object) {
  const Id file(H5Iget_file_id(object.get()), H5Fclose, "HDF5 file");
  hsize_t bytes = 0;
  check(H5Fget_filesize(file.get(), &bytes), "HDF5 size of the file");
  return bytes;
}

/// Opens a dataset and checks its type, columns and storage, and that the file has room for its
/// rows. Returns it with its number of rows.
template <typename Number>
std::pair<Id, std::uint64_t> open_dataset(const Id& parent, const std::string& name,
                                          std::uint64_t columns, const std::string& file) {
  Id dataset = open_dataset(parent, name, file);
  const Id type(H5Dget_type(dataset.get()), H5Tclose, name);
  if (H5Tequal(type.get(), file_type<Number>()) <= 0) {
    malformed(file, name, std::to_string(8 * sizeof(Number)) + "-bit numbers of the type written");
  }
  const Id space(H5Dget_space(dataset.get()), H5Sclose, name);
  std::array<hsize_t, 2> size{};
  const int dimensions = columns == 0 ? 1 : 2;
  if (H5Sget_simple_extent_ndims(space.get()) != dimensions ||
      H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) != dimensions ||
      (columns != 0 && size[1] != columns)) {
    malformed(file, name,
              columns == 0 ? "one dimension" : std::to_string(columns) + " numbers a row");
  }
  if (!has_checked_layout(dataset, size[0], dimensions, sizeof(Number))) {
    malformed(file, name, "chunks with fletcher32, as Clearway writes them");
  }
  const std::uint64_t row_bytes = std::max<std::uint64_t>(columns, 1) * sizeof(Number);
  if (size[0] > bytes_of_file(dataset) / row_bytes) {
    malformed(file, name, "no more rows than the file has room for");
  }
  return {std::move(dataset), size[0]};
}

}  // namespace

template <typename Number>
void write_dataset(const Id& parent, const std::string& name, std::span<const Number> values,
                   std::uint64_t columns) {
  const std::uint64_t rows = columns == 0 ? values.size() : values.size() / columns;
  Id dataset = create_dataset<Number>(parent, name, rows, columns);
  if (values.empty()) return;
  check(
      H5Dwrite(dataset.get(), memory_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
      "write dataset " + name);
  dataset.close("write dataset " + name);  // closing writes its chunks
}

template <typename Number>
std::vector<Number> read_dataset(const Id& parent, const std::string& name, std::uint64_t rows,
                                 std::uint64_t columns, const std::string& file) {
  const auto [dataset, found] = open_dataset<Number>(parent, name, columns, file);
  if (found != rows) malformed(file, name, std::to_string(rows) + " rows");
  std::vector<Number> values(rows * std::max<std::uint64_t>(columns, 1));
  if (!values.empty() && H5Dread(dataset.get(), memory_type<Number>(), H5S_ALL, H5S_ALL,
                                 H5P_DEFAULT, values.data()) < 0) {
    malformed(file, name, "intact data (" + reason() + ")");
  }
  return values;
}

std::uint64_t dataset_rows(const Id& parent, const std::string& name, const std::string& file) {
  const Id dataset = open_dataset(parent, name, file);
  const Id space(H5Dget_space(dataset.get()), H5Sclose, name);
  std::array<hsize_t, H5S_MAX_RANK> size{};
  if (H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) < 1) {
    malformed(file, name, "one or two dimensions");
  }
  return size[0];
}

template <typename Number>
Rows<Number>::Rows(const Id& parent, const std::string& name, std::uint64_t rows,
                   std::uint64_t columns)
    : dataset_(create_dataset<Number>(parent, name, rows, columns)),
      rows_(rows),
      columns_(columns),
      name_(name) {}

template <typename Number>
Rows<Number> Rows<Number>::open(const Id& parent, const std::string& name, std::uint64_t columns,
                                const std::string& file) {
  Rows rows;
  std::tie(rows.dataset_, rows.rows_) = open_dataset<Number>(parent, name, columns, file);
  rows.columns_ = columns;
  rows.name_ = name;
  rows.file_ = file;
  return rows;
}

template <typename Number>
Id Rows<Number>::select(std::uint64_t first_row, std::uint64_t row_count, Id& memory_space) const {
  const std::array<hsize_t, 2> start{first_row, 0};
  const std::array<hsize_t, 2> count{row_count, columns_};
  memory_space = simple_space(row_count, columns_);
  Id space(H5Dget_space(dataset_.get()), H5Sclose, name_);
  check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                            nullptr),
        name_);
  return space;
}

template <typename Number>
void Rows<Number>::write(std::uint64_t first_row, std::span<const Number> values) {
  if (values.empty()) return;
  Id memory;
  const Id space = select(first_row, values.size() / std::max<std::uint64_t>(columns_, 1), memory);
  check(H5Dwrite(dataset_.get(), memory_type<Number>(), memory.get(), space.get(), H5P_DEFAULT,
                 values.data()),
        "write dataset " + name_);
}

template <typename Number>
void Rows<Number>::close() {
  dataset_.close("write dataset " + name_);
}

template <typename Number>
void Rows<Number>::read(std::uint64_t first_row, std::span<Number> values) const {
  if (values.empty()) return;
  Id memory;
  const Id space = select(first_row, values.size() / std::max<std::uint64_t>(columns_, 1), memory);
  if (H5Dread(dataset_.get(), memory_type<Number>(), memory.get(), space.get(), H5P_DEFAULT,
              values.data()) < 0) {
    malformed(file_, name_, "intact data (" + reason() + ")");
  }
}

template <typename Number>
std::uint64_t Rows<Number>::chunk_rows() const {
  return rows_of_chunk(rows_, std::max<std::uint64_t>(columns_, 1) * sizeof(Number));
}

#define CLEARWAY_INSTANTIATE(Number)                                                      \
  template void write_dataset(const Id&, const std::string&, std::span<const Number>,     \
                              std::uint64_t);                                             \
  template std::vector<Number> read_dataset(const Id&, const std::string&, std::uint64_t, \
                                            std::uint64_t, const std::string&);           \
  template class Rows<Number>;

CLEARWAY_INSTANTIATE(std::uint8_t)
CLEARWAY_INSTANTIATE(std::uint16_t)
CLEARWAY_INSTANTIATE(std::int32_t)
CLEARWAY_INSTANTIATE(std::uint32_t)
CLEARWAY_INSTANTIATE(std::int64_t)
CLEARWAY_INSTANTIATE(std::uint64_t)
CLEARWAY_INSTANTIATE(double)
#undef CLEARWAY_INSTANTIATE

}  // namespace clearway::hdf5
