#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "clearway/error.hpp"

/// Owners and the few calls of HDF5 that Clearway uses. All HDF5 calls of a file are made by one
/// thread. Files are written with H5F_LIBVER_V110 on both bounds, no object times, fletcher32 on
/// every unpacked dataset and fixed-length strings, so that equal contents give equal bytes and
/// damaged metadata is noticed (docs/design/store-format.md).
namespace clearway::hdf5 {

/// A call of HDF5 that failed. Its text does not name the file; naming() adds that.
struct CallFailure : ResourceError {
  using ResourceError::ResourceError;
  explicit CallFailure(const ResourceError& error) : ResourceError(error) {}
};

/// Failure of HDF5 without a failed system call. For a file that is read, this means damaged
/// contents.
struct Failure : CallFailure {
  using CallFailure::CallFailure;
};

/// During its lifetime, HDF5 prints nothing on this thread and loads no filter plug-ins, because a
/// file must not choose which code runs. The destructor restores the caller's settings.
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

/// Makes HDF5 quiet, as QuietScope does, for the life of the process. Also prevents its clean-up at
/// exit, which crashes on a file whose closing failed (a full disk); every Id closes its own
/// object. For programs, before any other call.
void silence_for_good();

/// Move-only owner of an HDF5 identifier; closes it with the function for its kind.
class Id {
 public:
  using Close = herr_t (*)(hid_t);

  Id() = default;
  /// Takes over an identifier. Throws ResourceError "`what`" with HDF5's own reason when id < 0.
  Id(hid_t id, Close close_with, const std::string& what);
  Id(Id&& other) noexcept;
  Id& operator=(Id&& other) noexcept;
  ~Id();

  hid_t get() const { return id_; }
  /// Closes the object now. Throws ResourceError on failure, such as a full disk.
  void close(const std::string& what);

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Runs `call` quietly. A CallFailure becomes a ResourceError with the file's name in front.
template <typename Call>
decltype(auto) naming(const std::string& file, Call call) {
  const QuietScope quiet;
  try {
    return call();
  } catch (const CallFailure& error) {
    throw ResourceError(file + ": " + error.what(), error.remedy(), error.amount());
  }
}

/// Throws CallFailure "`what`: reason", a Failure unless a system call failed, when status < 0.
void check(herr_t status, const std::string& what);

Id create_file(const std::filesystem::path& path);
/// Opens a file for reading. Throws InputError when it does not start as create_file() makes it,
/// does not have the length that it states, or cannot be opened as HDF5.
Id open_file(const std::filesystem::path& path);
/// Creates a group unless it is there already.
void require_group(const Id& parent, const std::string& name);
/// Opens a dataset of the file itself, whose type, shape and storage are not checked. Throws
/// InputError where it is missing or damaged, or where the name is a link, which may lead out of
/// the file. file: its name for messages.
Id open_dataset(const Id& parent, const std::string& name, const std::string& file);

/// The HDF5 type of a C++ number, which is little-endian in the file and in memory.
template <typename Number>
hid_t file_type();

// clang-format off
template <> inline hid_t file_type<std::uint8_t>() { return H5T_STD_U8LE; }
template <> inline hid_t file_type<std::uint16_t>() { return H5T_STD_U16LE; }
template <> inline hid_t file_type<std::int32_t>() { return H5T_STD_I32LE; }
template <> inline hid_t file_type<std::uint32_t>() { return H5T_STD_U32LE; }
template <> inline hid_t file_type<std::uint64_t>() { return H5T_STD_U64LE; }
template <> inline hid_t file_type<std::int64_t>() { return H5T_STD_I64LE; }
template <> inline hid_t file_type<double>() { return H5T_IEEE_F64LE; }
// clang-format on

/// Writes an attribute of `count` numbers of a type.
void write_attribute(const Id& object, const std::string& name, hid_t type, std::size_t count,
                     const void* numbers);
void write_attribute(const Id& object, const std::string& name, const std::string& text);

/// Writes an attribute of one number.
template <typename Number>
void write_number(const Id& object, const std::string& name, Number value) {
  write_attribute(object, name, file_type<Number>(), 1, &value);
}

/// Whether the object has an attribute. Throws like read_number() where this cannot be determined.
bool has_attribute(const Id& object, const std::string& name, const std::string& file);
/// Reads an attribute of one number of a type. Throws InputError where it is missing or another.
void read_attribute(const Id& object, const std::string& name, hid_t type, void* number,
                    const std::string& file);
template <typename Number>
Number read_number(const Id& object, const std::string& name, const std::string& file) {
  Number number{};
  read_attribute(object, name, file_type<Number>(), &number, file);
  return number;
}
std::string read_text_attribute(const Id& object, const std::string& name, const std::string& file);

}  // namespace clearway::hdf5
