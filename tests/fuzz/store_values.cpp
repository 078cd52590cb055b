// A store whose checksums hold but whose numbers are arbitrary, so that HDF5 finds nothing wrong
// with it. The input is a list of edits of 11 bytes each: what, where (2 bytes), value (8 bytes).
#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <set>

#include "io/files/hdf5.hpp"
#include "io/files/xxh64.hpp"
#include "read_store.hpp"
#include "support/clouds.hpp"

using namespace clearway;
using namespace clearway::test;

namespace {

constexpr std::size_t kEditBytes = 11;
constexpr std::size_t kMostEdits = 8;

struct Edit {
  unsigned what;
  std::uint16_t where;
  std::uint64_t value;
};

Edit edit_at(const std::uint8_t* bytes) {
  Edit edit{bytes[0], 0, 0};
  std::memcpy(&edit.where, bytes + 1, 2);
  std::memcpy(&edit.value, bytes + 3, 8);
  return edit;
}

constexpr const char* kDatasets[] = {"cells/count", "cells/box",     "cells/address",
                                     "cells/bytes", "cells/xxh64",   "blocks/box",
                                     "tree/nodes",  "sources/names", "sources/bytes"};
constexpr const char* kAttributes[] = {"point_count", "input_points", "cell_points",
                                       "points_hash", "scale",        "offset",
                                       "length_unit", "layout",       "steps"};
/// The number of things to edit: values of datasets, their extents, and attributes. One more stands
/// for the packed chunks.
constexpr unsigned kWhats = 2 * std::size(kDatasets) + std::size(kAttributes);

bool is_of_chunk(const Edit& edit) { return edit.what % (kWhats + 1) == kWhats; }

/// The values of a dataset; empty where it is too large to be read.
std::vector<std::byte> values_of(const hdf5::Id& dataset, const hdf5::Id& type) {
  constexpr hssize_t kMost = 1 << 16;
  const hdf5::Id space(H5Dget_space(dataset.get()), H5Sclose, "space");
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  std::vector<std::byte> values(count > kMost || count < 0 ? 0 : count * H5Tget_size(type.get()));
  if (values.empty()) return values;
  hdf5::check(H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
              "read");
  return values;
}

void edit_dataset(hid_t file, const char* name, const Edit& edit) {
  const hdf5::Id dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, name);
  const hdf5::Id type(H5Dget_type(dataset.get()), H5Tclose, name);
  std::vector<std::byte> values = values_of(dataset, type);
  if (values.empty()) return;
  const std::size_t size = H5Tget_size(type.get());
  std::memcpy(values.data() + edit.where % (values.size() / size) * size, &edit.value, size);
  hdf5::check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
              name);
}

std::vector<std::byte> values_in(hid_t file, const char* name) {
  const hdf5::Id dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, name);
  const hdf5::Id type(H5Dget_type(dataset.get()), H5Tclose, name);
  return values_of(dataset, type);
}

/// The datasets that `index_hash` covers, in its order.
constexpr const char* kHashed[] = {"sources/names", "sources/bytes", "sources/xxh64", "cells/count",
                                   "cells/box",     "cells/address", "cells/bytes",   "cells/xxh64",
                                   "blocks/box",    "tree/nodes"};

/// A sound store with cells of 64 points, the last of 44, and the values that its index hash
/// covers.
struct SoundStore {
  SoundStore() {
    const ScratchFolder folder;
    write_las(folder / "a.las", cube_cloud(300, -4000, 4000, 3));
    convert_quietly(conversion_of({folder / "a.las"}, folder / "a.h5"));
    bytes = bytes_of(folder / "a.h5");
    index = StoreReader(folder / "a.h5").index();
    const hdf5::Id file(H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                        "file");
    for (const char* name : kHashed) hashed.push_back(values_in(file.get(), name));
  }

  std::string bytes;
  CellIndex index;
  std::vector<std::vector<std::byte>> hashed;
};

/// Sets `index_hash` to the hash of what the datasets hold. Only edited datasets are read again.
void rehash(hid_t file, const SoundStore& sound, const std::set<std::string>& edited) {
  ColumnHashes hashes;
  for (std::size_t i = 0; i < std::size(kHashed); ++i) {
    hashes.add(edited.contains(kHashed[i]) ? values_in(file, kHashed[i]) : sound.hashed[i]);
  }
  const std::uint64_t digest = hashes.digest();
  const hdf5::Id attribute(H5Aopen(file, "index_hash", H5P_DEFAULT), H5Aclose, "index_hash");
  hdf5::check(H5Awrite(attribute.get(), H5T_NATIVE_UINT64, &digest), "index_hash");
}

/// Replaces a dataset by one of another extent in which nothing is written.
void resize_dataset(hid_t file, const char* name, const Edit& edit) {
  const hdf5::Id dataset(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, name);
  const hdf5::Id type(H5Dget_type(dataset.get()), H5Tclose, name);
  const hdf5::Id list(H5Dget_create_plist(dataset.get()), H5Pclose, name);
  const hdf5::Id space(H5Dget_space(dataset.get()), H5Sclose, name);
  hsize_t extent[2]{};
  const int rank = H5Sget_simple_extent_dims(space.get(), extent, nullptr);
  extent[edit.where % static_cast<unsigned>(rank)] = edit.value >> edit.where % 64;
  const hid_t other = H5Screate_simple(rank, extent, nullptr);
  if (other < 0) return;
  const hdf5::Id other_space(other, H5Sclose, name);
  hdf5::check(H5Ldelete(file, name, H5P_DEFAULT), name);
  const hid_t created =
      H5Dcreate2(file, name, type.get(), other_space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT);
  if (created >= 0) H5Dclose(created);
}

void edit_attribute(hid_t file, const char* name, const Edit& edit) {
  const hdf5::Id attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose, name);
  const hdf5::Id type(H5Aget_type(attribute.get()), H5Tclose, name);
  std::vector<std::byte> value(H5Aget_storage_size(attribute.get()));
  hdf5::check(H5Aread(attribute.get(), type.get(), value.data()), name);
  const std::size_t step = std::min<std::size_t>(8, value.size());
  std::memcpy(value.data() + edit.where % (value.size() / step) * step, &edit.value, step);
  hdf5::check(H5Awrite(attribute.get(), type.get(), value.data()), name);
}

/// Changes bytes of a packed chunk.
void edit_chunk(std::string& bytes, const CellIndex& index, const Edit& edit) {
  const std::size_t chunk = edit.where % index.bytes.size();
  const std::size_t at = edit.where / index.bytes.size() % (index.bytes[chunk] - 8);
  std::memcpy(bytes.data() + index.address[chunk] + at, &edit.value, 8);
}

/// Sets the hashes of packed chunks to those of `bytes`.
void rehash_chunks(hid_t file, std::string_view bytes, const CellIndex& index) {
  std::vector<std::uint64_t> hashes = index.xxh64;
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    hashes[i] = xxh64(std::as_bytes(std::span(bytes.substr(index.address[i], index.bytes[i]))));
  }
  const hdf5::Id dataset(H5Dopen2(file, "cells/xxh64", H5P_DEFAULT), H5Dclose, "hashes");
  hdf5::check(
      H5Dwrite(dataset.get(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, hashes.data()),
      "hashes");
}

/// Applies the edits to the file, which has these bytes; HDF5 keeps its own checksums right.
void apply(std::span<const Edit> edits, const std::filesystem::path& path, std::string_view bytes,
           const SoundStore& sound) {
  const hdf5::Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "file");
  std::set<std::string> edited;
  if (std::any_of(edits.begin(), edits.end(), is_of_chunk)) {
    rehash_chunks(file.get(), bytes, sound.index);
    edited.insert("cells/xxh64");
  }
  for (const Edit& edit : edits) {
    if (is_of_chunk(edit)) continue;
    unsigned what = edit.what % (kWhats + 1);
    if (what < 2 * std::size(kDatasets)) edited.insert(kDatasets[what % std::size(kDatasets)]);
    if (what < std::size(kDatasets)) {
      edit_dataset(file.get(), kDatasets[what], edit);
    } else if ((what -= std::size(kDatasets)) < std::size(kDatasets)) {
      resize_dataset(file.get(), kDatasets[what], edit);
    } else {
      edit_attribute(file.get(), kAttributes[what - std::size(kDatasets)], edit);
    }
  }
  rehash(file.get(), sound, edited);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  // HDF5 is to keep the memory that it frees: it would give back a file's tables, which have
  // 600 KiB, each time.
  H5set_free_list_limits(-1, -1, -1, -1, -1, -1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const SoundStore sound;
  std::vector<Edit> edits;
  for (; size >= kEditBytes && edits.size() < kMostEdits; size -= kEditBytes, data += kEditBytes) {
    edits.push_back(edit_at(data));
  }
  std::string bytes = sound.bytes;
  for (const Edit& edit : edits) {
    if (is_of_chunk(edit)) edit_chunk(bytes, sound.index, edit);
  }
  const MemoryFile file({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  may_refuse([&] { apply(edits, file.path(), bytes, sound); });
  may_refuse([&] { read_store(file.path()); });
  return 0;
}
