#include "io/files/hdf5.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "clearway/error.hpp"
#include "io/files/bytes.hpp"
#include "io/files/file.hpp"
#include "io/files/hdf5_detail.hpp"
#include "io/files/xxh64.hpp"

namespace clearway::hdf5 {
namespace {

constexpr unsigned kRootAttributes = 64;

constexpr unsigned kNoPlugins = 0;

Id latest_format() {
  Id access = property_list(H5P_FILE_ACCESS);
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110),
        "HDF5 library version bounds");
  // Keeps other allocations out of shared blocks between two raw chunks, so that the next chunk
  // goes to the end of the file.
  check(H5Pset_small_data_block_size(access.get(), 0), "HDF5 small data block size");
  // PendingFile locks the file that is being written, with which HDF5's own lock would interfere.
  check(H5Pset_file_locking(access.get(), false, true), "HDF5 file locking");
  return access;
}

/// Checks the superblock before HDF5 reads it: the file must be one of create_file() that was
/// closed, and have its whole length. HDF5 also reads older formats, whose metadata has no
/// checksums.
void check_superblock(const File& file) {
  constexpr std::string_view kSignature("\x89HDF\r\n\x1a\n");
  constexpr std::size_t kVersionAt = 8, kSizesAt = 9, kFlagsAt = 11, kBaseAt = 12, kEndAt = 28;
  constexpr unsigned kVersion = 3, kEightByteSizes = 0x0808;
  std::array<std::byte, 48> bytes{};
  const std::uint64_t size = file.size_bytes();
  file.read_at(0, std::span(bytes).first(std::min<std::uint64_t>(bytes.size(), size)));
  if (std::memcmp(bytes.data(), kSignature.data(), kSignature.size()) != 0) {
    throw InputError(file.name() + ": not an HDF5 file, expected one that Clearway wrote");
  }
  const unsigned version = load<std::uint8_t>(bytes.data() + kVersionAt);
  if (version != kVersion || load<std::uint16_t>(bytes.data() + kSizesAt) != kEightByteSizes) {
    throw InputError(
        file.name() + ": HDF5 superblock of version " + std::to_string(version) + ", expected " +
        std::to_string(kVersion) +
        ". Another tool (h5repack, a copy by h5py) wrote or rewrote the file; convert the scans "
        "again, run again for a result, or copy the file as it is");
  }
  if (load<std::uint8_t>(bytes.data() + kFlagsAt) != 0) {
    throw InputError(file.name() + ": damaged HDF5 file: it was not closed by its writer");
  }
  const auto end = load<std::uint64_t>(bytes.data() + kEndAt);
  if (load<std::uint64_t>(bytes.data() + kBaseAt) != 0 || end != size) {
    throw InputError(file.name() + ": damaged HDF5 file: it has " + std::to_string(size) +
                     " bytes, expected " + std::to_string(end));
  }
}

/// HDF5's last failure: what its innermost call says, and the value of errno where that was a
/// system call, otherwise 0.
struct LastFailure {
  std::string text;
  int error = 0;
};

/// To be called before anything else may change errno.
LastFailure last_failure() {
  const int error = errno;
  struct Innermost {
    std::string text;
    hid_t major = -1, minor = -1;
  } innermost;
  const auto take = [](unsigned depth, const H5E_error2_t* entry, void* out) -> herr_t {
    if (depth > 0) return 0;
    *static_cast<Innermost*>(out) = {entry->desc == nullptr ? "" : entry->desc, entry->maj_num,
                                     entry->min_num};
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take, &innermost);
  // What reads, writes, cuts and closes files, and what opens them. create_file() and open_file()
  // begin with errno 0, because a file may also be refused without a system call.
  const bool of_system = innermost.major == H5E_IO ||
                         (innermost.major == H5E_FILE && innermost.minor == H5E_CANTOPENFILE);
  return {std::move(innermost.text), of_system ? error : 0};
}

}  // namespace

std::string reason() {
  const LastFailure last = last_failure();
  if (last.error != 0) return std::strerror(last.error);
  return last.text.empty() ? "HDF5 gives no reason" : last.text;
}

void fail(const std::string& what) {
  const LastFailure last = last_failure();
  if (last.error != 0) throw CallFailure(system_failure(what, last.error));
  throw Failure(what + ": " + reason());
}

void malformed(const std::string& file, const std::string& name, const std::string& expected) {
  const LastFailure last = last_failure();
  if (last.error != 0) throw system_failure(file + ": cannot read", last.error);
  throw InputError(file + ": dataset or attribute '" + name + "': expected " + expected);
}

void silence_for_good() {
  H5dont_atexit();
  H5PLset_loading_state(kNoPlugins);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

namespace {

/// The plug-ins that HDF5 loads are one state of the whole process. The first of all threads that
/// are quiet at a time saves it, and the last restores it.
struct Plugins {
  std::mutex mutex;
  int quiet = 0;
  unsigned kept = 0;
};

Plugins& plugins() {
  static Plugins all;
  return all;
}

}  // namespace

QuietScope::QuietScope() {
  H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Plugins& all = plugins();
  const std::lock_guard lock(all.mutex);
  if (all.quiet++ > 0) return;
  H5PLget_loading_state(&all.kept);
  H5PLset_loading_state(kNoPlugins);
}

QuietScope::~QuietScope() {
  {
    Plugins& all = plugins();
    const std::lock_guard lock(all.mutex);
    if (--all.quiet == 0) H5PLset_loading_state(all.kept);
  }
  H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
}

Id property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose, "HDF5 property list"}; }

Id untimed(hid_t kind) {
  Id list = property_list(kind);
  check(H5Pset_obj_track_times(list.get(), false), "HDF5 object times");
  return list;
}

Id simple_space(std::uint64_t rows, std::uint64_t columns) {
  const std::array<hsize_t, 2> size{rows, columns};
  return {H5Screate_simple(columns == 0 ? 1 : 2, size.data(), nullptr), H5Sclose, "HDF5 dataspace"};
}

Id::Id(hid_t id, Close close_with, const std::string& what) : id_(id), close_(close_with) {
  if (id < 0) fail(what);
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
  if (status < 0) fail(what);
}

Id create_file(const std::filesystem::path& path) {
  const Id creation = untimed(H5P_FILE_CREATE);
  // Keeps attributes in the root's checksummed header. HDF5 otherwise moves many or long ones to a
  // heap, which has no checksum for attributes of a few kilobytes or more.
  check(H5Pset_attr_phase_change(creation.get(), kRootAttributes, 0), "HDF5 attribute storage");
  const Id access = latest_format();
  errno = 0;
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose,
          "cannot create"};
}

Id open_file(const std::filesystem::path& path) {
  check_superblock(File::open_regular(path));
  // With default properties a process may open a file twice, as h5py opens it in the same way.
  errno = 0;
  const hid_t id = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (id < 0) {
    const LastFailure last = last_failure();
    if (last.error != 0) throw system_failure(path.string(), last.error);
    throw InputError(path.string() + ": damaged HDF5 file: " + reason());
  }
  return {id, H5Fclose, path.string()};
}

void require_own_link(const Id& parent, const std::string& path, const std::string& file) {
  for (std::size_t end = 0; end != std::string::npos;) {
    end = path.find('/', end + 1);
    H5L_info_t link{};
    if (H5Lget_info(parent.get(), path.substr(0, end).c_str(), &link, H5P_DEFAULT) < 0) {
      malformed(file, path, "to exist and be intact (" + reason() + ")");
    }
    if (link.type != H5L_TYPE_HARD) malformed(file, path, "an object of this file, found a link");
  }
}

Id open_dataset(const Id& parent, const std::string& name, const std::string& file) {
  require_own_link(parent, name, file);
  const hid_t opened = H5Dopen2(parent.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) malformed(file, name, "to exist and be intact (" + reason() + ")");
  return {opened, H5Dclose, name};
}

void require_group(const Id& parent, const std::string& name) {
  if (H5Lexists(parent.get(), name.c_str(), H5P_DEFAULT) > 0) return;
  const Id creation = untimed(H5P_GROUP_CREATE);
  const Id group(H5Gcreate2(parent.get(), name.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT),
                 H5Gclose, "create group " + name);
}

namespace {

constexpr std::size_t kLongestText = 1 << 20;  // longer than any CRS

struct Attribute {
  Id id, type;
  hssize_t numbers;  ///< number of numbers or strings
};

Attribute open_attribute(const Id& object, const std::string& name, const std::string& file) {
  const hid_t opened = H5Aopen(object.get(), name.c_str(), H5P_DEFAULT);
  if (opened < 0) malformed(file, name, "to exist and be intact (" + reason() + ")");
  Id attribute(opened, H5Aclose, name);
  Id type(H5Aget_type(opened), H5Tclose, name);
  const Id space(H5Aget_space(opened), H5Sclose, name);
  return {std::move(attribute), std::move(type), H5Sget_simple_extent_npoints(space.get())};
}

}  // namespace

void write_attribute(const Id& object, const std::string& name, hid_t type, std::size_t count,
                     const void* numbers) {
  const Id space = simple_space(count, 0);
  const Id attribute(
      H5Acreate2(object.get(), name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      "create attribute " + name);
  check(H5Awrite(attribute.get(), type, numbers), "write attribute " + name);
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

bool has_attribute(const Id& object, const std::string& name, const std::string& file) {
  const htri_t found = H5Aexists(object.get(), name.c_str());
  if (found < 0) malformed(file, name, "intact attributes (" + reason() + ")");
  return found > 0;
}

void read_attribute(const Id& object, const std::string& name, hid_t expected, void* number,
                    const std::string& file) {
  const auto [attribute, type, numbers] = open_attribute(object, name, file);
  if (H5Tequal(type.get(), expected) <= 0 || numbers != 1) {
    malformed(file, name, "one number of the type written");
  }
  check(H5Aread(attribute.get(), expected, number), file + ": read " + name);
}

std::string read_text_attribute(const Id& object, const std::string& name,
                                const std::string& file) {
  const auto [attribute, type, numbers] = open_attribute(object, name, file);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 ||
      numbers != 1) {
    malformed(file, name, "a fixed-length string");
  }
  if (H5Tget_size(type.get()) > kLongestText) malformed(file, name, "a text of at most 1 MiB");
  std::string text(H5Tget_size(type.get()), '\0');
  check(H5Aread(attribute.get(), type.get(), text.data()), file + ": read " + name);
  text.resize(text.find('\0') == std::string::npos ? text.size() : text.find('\0'));
  return text;
}

}  // namespace clearway::hdf5
