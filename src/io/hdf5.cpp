#include "io/hdf5.hpp"

#include <array>
#include <utility>

#include "core/error.hpp"
#include "io/file.hpp"
#include "io/hdf5_detail.hpp"

namespace clearway::hdf5 {
namespace {

constexpr unsigned kRootAttributes = 64;

/// Before the first other call. No automatic printing, and no clean-up at exit, which crashes on a
/// file whose closing failed (a full disk); an Id closes what is open.
void silence() {
  static const herr_t once = (H5dont_atexit(), H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr));
  (void)once;
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

}  // namespace

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

[[noreturn]] void malformed(const std::string& file, const std::string& name,
                            const std::string& expected) {
  throw InputError(file + ": dataset or attribute '" + name + "': expected " + expected);
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

}  // namespace clearway::hdf5
