#include "io/hdf5.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>
#include <utility>

#include "core/error.hpp"
#include "io/file.hpp"

namespace clearway::hdf5 {
namespace {

constexpr hsize_t kChunkBytes = 1 << 18;
constexpr unsigned kRootAttributes = 64;

/// HDF5's innermost reason; its automatic printing is off.
std::string reason() {
  std::string text;
  const auto take = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    auto& reason = *static_cast<std::string*>(out);
    if (reason.empty() && error->desc != nullptr) reason = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take, &text);
  // Of a failed system call only the system's words, not HDF5's addresses and clock.
  const std::string quote = "error message = '";
  if (const auto begin = text.find(quote); begin != std::string::npos) {
    const auto words = begin + quote.size();
    return text.substr(words, text.find('\'', words) - words);
  }
  return text.empty() ? "HDF5 gives no reason" : text;
}

/// Before the first other call. Without HDF5's clean-up at exit, which crashes on a file whose
/// closing failed (a full disk); an Id closes what is open.
void silence() {
  static const herr_t once = (H5dont_atexit(), H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr));
  (void)once;
}

Id property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose, "HDF5 property list"}; }

Id untimed(hid_t kind) {
  Id list = property_list(kind);
  check(H5Pset_obj_track_times(list.get(), false), "HDF5 object times");
  return list;
}

Id latest_format() {
  Id access = property_list(H5P_FILE_ACCESS);
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110),
        "HDF5 library version bounds");
  // Nothing else allocates from a shared block between two raw chunks, so that the end of the file
  // is where the next chunk goes.
  check(H5Pset_small_data_block_size(access.get(), 0), "HDF5 small data block size");
  // PendingFile locks the file that is being written: HDF5's own lock would be in its way.
  check(H5Pset_file_locking(access.get(), false, true), "HDF5 file locking");
  return access;
}

Id simple_space(std::uint64_t rows, std::uint64_t columns) {
  const std::array<hsize_t, 2> size{rows, columns};
  return {H5Screate_simple(columns == 0 ? 1 : 2, size.data(), nullptr), H5Sclose, "HDF5 dataspace"};
}

/// Chunked with fletcher32 by a power of two of rows, at most kChunkBytes, so that row ranges of
/// 2^16 end at the ends of chunks whatever the columns; an empty dataset has no chunks.
Id checked_layout(std::uint64_t rows, std::uint64_t columns, std::size_t number_bytes) {
  Id list = untimed(H5P_DATASET_CREATE);
  if (rows == 0) return list;
  const std::uint64_t row_bytes = std::max<std::uint64_t>(columns, 1) * number_bytes;
  const std::uint64_t chunk_rows =
      std::min(rows, std::bit_floor(std::max<std::uint64_t>(1, kChunkBytes / row_bytes)));
  const std::array<hsize_t, 2> chunk{chunk_rows, std::max<std::uint64_t>(columns, 1)};
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

[[noreturn]] void malformed(const std::string& file, const std::string& name,
                            const std::string& expected) {
  throw InputError(file + ": dataset or attribute '" + name + "': expected " + expected);
}

/// Opens a dataset and checks type and columns; gives its rows.
template <typename Number>
std::pair<Id, std::uint64_t> open_dataset(const Id& parent, const std::string& name,
                                          std::uint64_t columns, const std::string& file) {
  const hid_t opened = H5Dopen2(parent.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) malformed(file, name, "to exist and be intact (" + reason() + ")");
  Id dataset(opened, H5Dclose, name);
  const Id type(H5Dget_type(opened), H5Tclose, name);
  if (H5Tequal(type.get(), file_type<Number>()) <= 0) {
    malformed(file, name, std::to_string(8 * sizeof(Number)) + "-bit numbers of the type written");
  }
  const Id space(H5Dget_space(opened), H5Sclose, name);
  std::array<hsize_t, 2> size{};
  const int dimensions = columns == 0 ? 1 : 2;
  if (H5Sget_simple_extent_ndims(space.get()) != dimensions ||
      H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) != dimensions ||
      (columns != 0 && size[1] != columns)) {
    malformed(file, name,
              columns == 0 ? "one dimension" : std::to_string(columns) + " numbers a row");
  }
  return {std::move(dataset), size[0]};
}

}  // namespace

Id::Id(hid_t id, Close close_with, const std::string& what) : id_(id), close_(close_with) {
  silence();
  if (id < 0) throw ResourceError(what + ": " + reason());
}

Id::Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

Id& Id::operator=(Id&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(close_, other.close_);
  return *this;
}

Id::~Id() {
  if (id_ >= 0) close_(id_);
}

void Id::close(const std::string& what) {
  if (id_ >= 0) check(close_(std::exchange(id_, -1)), what);
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw ResourceError(what + ": " + reason());
}

Id create_file(const std::filesystem::path& path) {
  silence();
  const Id creation = untimed(H5P_FILE_CREATE);
  // Attributes stay in the root's checksummed header: the heap that holds many or long ones
  // otherwise has no checksum for those of a few kilobytes and more.
  check(H5Pset_attr_phase_change(creation.get(), kRootAttributes, 0), "HDF5 attribute storage");
  const Id access = latest_format();
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose,
          path.string() + ": cannot create"};
}

Id open_file(const std::filesystem::path& path) {
  silence();
  File::open_for_reading(path);  // HDF5 does not say that a file is missing
  if (H5Fis_hdf5(path.c_str()) <= 0) {
    throw InputError(path.string() + ": not an HDF5 file, expected one that Clearway wrote");
  }
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) throw InputError(path.string() + ": damaged HDF5 file: " + reason());
  return {id, H5Fclose, path.string()};
}

bool holds(const std::filesystem::path& path, const std::string& name) {
  const Id file = open_file(path);
  return H5Lexists(file.get(), name.c_str(), H5P_DEFAULT) > 0;
}

Id create_group(const Id& parent, const std::string& name) {
  const Id creation = untimed(H5P_GROUP_CREATE);
  return {H5Gcreate2(parent.get(), name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
          H5Gclose, "create group " + name};
}

// clang-format off
template <> hid_t file_type<std::uint8_t>() { return H5T_STD_U8LE; }
template <> hid_t memory_type<std::uint8_t>() { return H5T_NATIVE_UINT8; }
template <> hid_t file_type<std::uint16_t>() { return H5T_STD_U16LE; }
template <> hid_t memory_type<std::uint16_t>() { return H5T_NATIVE_UINT16; }
template <> hid_t file_type<std::int32_t>() { return H5T_STD_I32LE; }
template <> hid_t memory_type<std::int32_t>() { return H5T_NATIVE_INT32; }
template <> hid_t file_type<std::uint32_t>() { return H5T_STD_U32LE; }
template <> hid_t memory_type<std::uint32_t>() { return H5T_NATIVE_UINT32; }
template <> hid_t file_type<std::uint64_t>() { return H5T_STD_U64LE; }
template <> hid_t memory_type<std::uint64_t>() { return H5T_NATIVE_UINT64; }
template <> hid_t file_type<double>() { return H5T_IEEE_F64LE; }
template <> hid_t memory_type<double>() { return H5T_NATIVE_DOUBLE; }
// clang-format on

template <typename Number>
void write_dataset(const Id& parent, const std::string& name, std::span<const Number> values,
                   std::uint64_t columns) {
  const std::uint64_t rows = columns == 0 ? values.size() : values.size() / columns;
  const Id dataset = create_dataset<Number>(parent, name, rows, columns);
  if (values.empty()) return;
  check(
      H5Dwrite(dataset.get(), memory_type<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
      "write dataset " + name);
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
  const hid_t opened = H5Dopen2(parent.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) malformed(file, name, "to exist and be intact (" + reason() + ")");
  const Id dataset(opened, H5Dclose, name);
  const Id space(H5Dget_space(opened), H5Sclose, name);
  std::array<hsize_t, H5S_MAX_RANK> size{};
  if (H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) < 1) {
    malformed(file, name, "one or two dimensions");
  }
  return size[0];
}

template <typename Number>
void write_attribute(const Id& object, const std::string& name, std::span<const Number> values) {
  const Id space = simple_space(values.size(), 0);
  const Id attribute(H5Acreate2(object.get(), name.c_str(), file_type<Number>(), space.get(),
                                H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose, "create attribute " + name);
  check(H5Awrite(attribute.get(), memory_type<Number>(), values.data()), "write attribute " + name);
}

void write_attribute(const Id& object, const std::string& name, const std::string& text) {
  const Id type(H5Tcopy(H5T_C_S1), H5Tclose, "HDF5 string type");
  check(H5Tset_size(type.get(), text.size() + 1), "HDF5 string size");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "HDF5 string encoding");
  const Id space(H5Screate(H5S_SCALAR), H5Sclose, "HDF5 dataspace");
  const Id attribute(
      H5Acreate2(object.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose, "create attribute " + name);
  check(H5Awrite(attribute.get(), type.get(), text.c_str()), "write attribute " + name);
}

template <typename Number>
std::vector<Number> read_attribute(const Id& object, const std::string& name, std::size_t count,
                                   const std::string& file) {
  const hid_t opened = H5Aopen(object.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) malformed(file, name, "to exist and be intact (" + reason() + ")");
  const Id attribute(opened, H5Aclose, name);
  const Id type(H5Aget_type(opened), H5Tclose, name);
  const Id space(H5Aget_space(opened), H5Sclose, name);
  if (H5Tequal(type.get(), file_type<Number>()) <= 0 ||
      H5Sget_simple_extent_npoints(space.get()) != static_cast<hssize_t>(count)) {
    malformed(file, name, std::to_string(count) + " numbers of the type written");
  }
  std::vector<Number> values(count);
  check(H5Aread(opened, memory_type<Number>(), values.data()), file + ": read " + name);
  return values;
}

std::string read_text_attribute(const Id& object, const std::string& name,
                                const std::string& file) {
  const hid_t opened = H5Aopen(object.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) malformed(file, name, "to exist and be intact (" + reason() + ")");
  const Id attribute(opened, H5Aclose, name);
  const Id type(H5Aget_type(opened), H5Tclose, name);
  const Id space(H5Aget_space(opened), H5Sclose, name);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      H5Sget_simple_extent_npoints(space.get()) != 1) {
    malformed(file, name, "a fixed-length string");
  }
  std::string text(H5Tget_size(type.get()), '\0');
  check(H5Aread(opened, type.get(), text.data()), file + ": read " + name);
  text.resize(text.find('\0') == std::string::npos ? text.size() : text.find('\0'));
  return text;
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
  rows.name_ = file + ": " + name;
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
void Rows<Number>::read(std::uint64_t first_row, std::span<Number> values) const {
  if (values.empty()) return;
  Id memory;
  const Id space = select(first_row, values.size() / std::max<std::uint64_t>(columns_, 1), memory);
  if (H5Dread(dataset_.get(), memory_type<Number>(), memory.get(), space.get(), H5P_DEFAULT,
              values.data()) < 0) {
    throw InputError(name_ + ": damaged data: " + reason());
  }
}

#define CLEARWAY_INSTANTIATE(Number)                                                      \
  template void write_dataset(const Id&, const std::string&, std::span<const Number>,     \
                              std::uint64_t);                                             \
  template std::vector<Number> read_dataset(const Id&, const std::string&, std::uint64_t, \
                                            std::uint64_t, const std::string&);           \
  template void write_attribute(const Id&, const std::string&, std::span<const Number>);  \
  template std::vector<Number> read_attribute(const Id&, const std::string&, std::size_t, \
                                              const std::string&);                        \
  template class Rows<Number>;

CLEARWAY_INSTANTIATE(std::uint8_t)
CLEARWAY_INSTANTIATE(std::uint16_t)
CLEARWAY_INSTANTIATE(std::int32_t)
CLEARWAY_INSTANTIATE(std::uint32_t)
CLEARWAY_INSTANTIATE(std::uint64_t)
CLEARWAY_INSTANTIATE(double)

}  // namespace clearway::hdf5
