#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "clearway/error.hpp"

/// Owners and the few calls of HDF5 that Clearway makes. All HDF5 calls of a file are made by one
/// thread. Files are written with H5F_LIBVER_V110 on both bounds, no object times, fletcher32 on
/// every unpacked dataset and fixed-length strings, so that equal contents give equal bytes and
/// damaged metadata is noticed (docs/design/store-format.md).
namespace clearway::hdf5 {

/// HDF5 could not do it though no system call failed: of a file that is read, damaged contents.
struct Failure : ResourceError {
  using ResourceError::ResourceError;
};

/// While it lives, HDF5 prints nothing on this thread and loads no filter plug-ins: which code runs
/// is not a file's to choose. Then everything is as the caller had it.
class QuietScope {
 public:
  QuietScope();
  ~QuietScope();
  QuietScope(const QuietScope&) = delete;
  QuietScope& operator=(const QuietScope&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

/// For programs, before any other call: the same for the life of the process, and no clean-up of
/// HDF5 at exit, which crashes on a file whose closing failed (a full disk); an Id closes its own.
void silence_for_good();

/// Move-only owner of an HDF5 identifier; closes it with the function for its kind.
class Id {
 public:
  using Close = herr_t (*)(hid_t);

  Id() = default;
  /// Throws ResourceError "`what`" with HDF5's own reason when id < 0.
  Id(hid_t id, Close close_with, const std::string& what);
  Id(Id&& other) noexcept;
  Id& operator=(Id&& other) noexcept;
  ~Id();

  hid_t get() const { return id_; }
  /// Closes now; throws ResourceError on failure (a full disk shows here).
  void close(const std::string& what);

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Runs `call` quietly, putting the file's name before the message of a failure that lacks it.
template <typename Call>
auto naming(const std::string& file, Call call) {
  const QuietScope quiet;
  try {
    return call();
  } catch (const ResourceError& error) {
    const std::string what = error.what();
    throw ResourceError(what.starts_with(file) ? what : file + ": " + what);
  }
}

/// Throws ResourceError "`what`: reason", a Failure unless a system call failed, when status < 0.
void check(herr_t status, const std::string& what);

Id create_file(const std::filesystem::path& path);
/// Throws InputError when the file does not start as create_file() makes one, has not the length
/// that it says, or cannot be opened as HDF5.
Id open_file(const std::filesystem::path& path);
/// Whether an HDF5 file has an object of this name at its root. Throws like open_file.
bool holds(const std::filesystem::path& path, const std::string& name);
Id create_group(const Id& parent, const std::string& name);
/// An object of the file itself: throws InputError where it is missing or damaged, or where the
/// name is a link, which may lead out of the file. `file` names it in messages.
Id open_group(const Id& parent, const std::string& name, const std::string& file);
/// The same; nothing is known of its type, shape and storage.
Id open_dataset(const Id& parent, const std::string& name, const std::string& file);

/// The HDF5 type of a C++ number, little-endian in the file.
template <typename Number>
hid_t file_type();
template <typename Number>
hid_t memory_type();

// clang-format off
template <> inline hid_t file_type<std::uint8_t>() { return H5T_STD_U8LE; }
template <> inline hid_t memory_type<std::uint8_t>() { return H5T_NATIVE_UINT8; }
template <> inline hid_t file_type<std::uint16_t>() { return H5T_STD_U16LE; }
template <> inline hid_t memory_type<std::uint16_t>() { return H5T_NATIVE_UINT16; }
template <> inline hid_t file_type<std::int32_t>() { return H5T_STD_I32LE; }
template <> inline hid_t memory_type<std::int32_t>() { return H5T_NATIVE_INT32; }
template <> inline hid_t file_type<std::uint32_t>() { return H5T_STD_U32LE; }
template <> inline hid_t memory_type<std::uint32_t>() { return H5T_NATIVE_UINT32; }
template <> inline hid_t file_type<std::uint64_t>() { return H5T_STD_U64LE; }
template <> inline hid_t memory_type<std::uint64_t>() { return H5T_NATIVE_UINT64; }
template <> inline hid_t file_type<double>() { return H5T_IEEE_F64LE; }
template <> inline hid_t memory_type<double>() { return H5T_NATIVE_DOUBLE; }
// clang-format on

/// Writes a one- or two-dimensional dataset, chunked by rows, with fletcher32.
/// values: rows x columns, row-major; columns 0 makes it one-dimensional.
template <typename Number>
void write_dataset(const Id& parent, const std::string& name, std::span<const Number> values,
                   std::uint64_t columns = 0);

/// Reads a whole dataset of `rows` x `columns` (columns 0: one-dimensional). Throws InputError when
/// it is missing, of another type, shape or storage than write_dataset gives it, larger than the
/// file, or fails its checksum; `file` names it in messages.
template <typename Number>
std::vector<Number> read_dataset(const Id& parent, const std::string& name, std::uint64_t rows,
                                 std::uint64_t columns, const std::string& file);

/// Rows of a one- or two-dimensional dataset, from its extent; not to be trusted before the dataset
/// was read.
std::uint64_t dataset_rows(const Id& parent, const std::string& name, const std::string& file);

/// columns: as write_dataset's.
template <typename Number>
void write_attribute(const Id& object, const std::string& name, std::span<const Number> values,
                     std::uint64_t columns = 0);
void write_attribute(const Id& object, const std::string& name, const std::string& text);

/// An attribute of one number.
template <typename Number>
void write_number(const Id& object, const std::string& name, Number value) {
  write_attribute<Number>(object, name, std::span(&value, 1));
}

/// Throws like read_attribute where that cannot be told.
bool has_attribute(const Id& object, const std::string& name, const std::string& file);
template <typename Number>
std::vector<Number> read_attribute(const Id& object, const std::string& name, std::size_t count,
                                   const std::string& file);
template <typename Number>
Number read_number(const Id& object, const std::string& name, const std::string& file) {
  return read_attribute<Number>(object, name, 1, file).front();
}
std::string read_text_attribute(const Id& object, const std::string& name, const std::string& file);

/// A one- or two-dimensional dataset written or read by ranges of rows.
template <typename Number>
class Rows {
 public:
  /// Creates rows x columns (columns 0: one-dimensional), as write_dataset.
  Rows(const Id& parent, const std::string& name, std::uint64_t rows, std::uint64_t columns);
  /// Opens an existing one; throws InputError as read_dataset does.
  static Rows open(const Id& parent, const std::string& name, std::uint64_t columns,
                   const std::string& file);

  std::uint64_t rows() const { return rows_; }
  void write(std::uint64_t first_row, std::span<const Number> values);
  /// Makes the index of a dataset with rows, as the first write() does. For write_chunk().
  void make_index();
  /// A whole chunk as stored_chunk.hpp has it, to where the file ends now. After make_index(), for
  /// all chunks, and without write().
  void write_chunk(std::uint64_t first_row, std::span<const std::byte> chunk);
  /// After the last write, which may fail as late as here.
  void close();
  void read(std::uint64_t first_row, std::span<Number> values) const;
  /// The chunks from `first_row`, which begins one, as stored_chunk.hpp has them, not checked.
  /// False where they are stored in another way or cannot be read: read() tells what is wrong then.
  bool read_chunks(std::uint64_t first_row, std::uint64_t row_count,
                   std::vector<std::vector<std::byte>>& chunks) const;
  /// Rows of a chunk of those.
  std::uint64_t chunk_rows() const;

 private:
  Rows() = default;
  Id select(std::uint64_t first_row, std::uint64_t row_count, Id& memory_space) const;

  Id dataset_;
  std::uint64_t rows_ = 0;
  std::uint64_t columns_ = 0;
  std::string name_;
  std::string file_;  ///< where it was opened
};

}  // namespace clearway::hdf5
