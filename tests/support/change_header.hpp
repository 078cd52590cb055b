#pragma once

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "io/files/json.hpp"
#include "io/files/table_file.hpp"
#include "io/files/xxh64.hpp"
#include "support/change_hdf5.hpp"

/// Changes of a file of tables whose hashes are right again afterwards, as a program that is not
/// Clearway could write it on purpose (docs/design/table-file.md).
namespace clearway::test {

/// An open dataset of one or two dimensions, its type, and its rows and numbers a row.
struct OpenDataset {
  OpenDataset(const hdf5::Id& file, const std::string& path)
      : id(H5Dopen2(file.get(), path.c_str(), H5P_DEFAULT), H5Dclose, path),
        type(H5Dget_type(id.get()), H5Tclose, path) {
    const hdf5::Id space(H5Dget_space(id.get()), H5Sclose, path);
    dimensions = H5Sget_simple_extent_dims(space.get(), size.data(), nullptr);
  }

  std::size_t row_bytes() const { return H5Tget_size(type.get()) * size[1]; }

  std::string bytes() const {
    std::string bytes(size[0] * row_bytes(), '\0');
    if (bytes.empty()) return bytes;
    hdf5::check(H5Dread(id.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), "read");
    return bytes;
  }

  hdf5::Id id, type;
  int dimensions = 0;
  std::array<hsize_t, 2> size{0, 1};
};

/// Replaces a dataset by one with other bytes, whose rows have the same form, in chunks as Clearway
/// writes them. Returns the hashes of its chunks.
inline std::vector<std::uint64_t> replace_bytes(const hdf5::Id& file, const std::string& path,
                                                std::span<const std::byte> bytes) {
  const OpenDataset old(file, path);
  std::array<hsize_t, 2> size{bytes.size() / old.row_bytes(), old.size[1]};
  std::array<hsize_t, 2> chunk{
      std::min<hsize_t>({size[0], std::bit_floor((1u << 18) / old.row_bytes()), kPieceRows}),
      size[1]};
  const hdf5::Id space(H5Screate_simple(old.dimensions, size.data(), nullptr), H5Sclose, path);
  const hdf5::Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path);
  if (size[0] > 0) {
    hdf5::check(H5Pset_chunk(list.get(), old.dimensions, chunk.data()), "chunk");
    hdf5::check(H5Pset_fletcher32(list.get()), "checksum");
  }
  hdf5::check(H5Ldelete(file.get(), path.c_str(), H5P_DEFAULT), path);
  const hdf5::Id changed(H5Dcreate2(file.get(), path.c_str(), old.type.get(), space.get(),
                                    H5P_DEFAULT, list.get(), H5P_DEFAULT),
                         H5Dclose, path);
  std::vector<std::uint64_t> hashes;
  if (size[0] == 0) return hashes;
  hdf5::check(H5Dwrite(changed.get(), old.type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()),
              path);
  hdf5::check(H5Dflush(changed.get()), path);  // gives the chunks their places
  for (std::array<hsize_t, 2> at{0, 0}; at[0] < size[0]; at[0] += chunk[0]) {
    std::vector<std::byte> stored(chunk[0] * old.row_bytes() + 4);
    std::uint32_t mask = 0;
    hdf5::check(H5Dread_chunk(changed.get(), H5P_DEFAULT, at.data(), &mask, stored.data()), path);
    hashes.push_back(xxh64(stored));
  }
  return hashes;
}

/// Puts bytes in the place of a file's header, sound or not, and their hash beside them.
inline void replace_header(const hdf5::Id& file, const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  replace_bytes(file, "header", bytes);
  hdf5::check(H5Adelete(file.get(), "header_hash"), "header_hash");
  hdf5::write_number(file, "header_hash", xxh64(bytes));
}

inline Json header_of(const hdf5::Id& file) {
  return parse_json(OpenDataset(file, "header").bytes());
}

/// Changes the facts of a file. edit: changes the JSON object that holds them.
inline void change_header(const std::filesystem::path& path,
                          const std::function<void(Json& header)>& edit) {
  const hdf5::Id file = open_to_change(path);
  Json header = header_of(file);
  edit(header);
  replace_header(file, indented_text(header, -1));
}

/// Gives a column other values, which may be more or fewer.
inline void change_column_bytes(const std::filesystem::path& path, const std::string& column,
                                std::span<const std::byte> values) {
  const hdf5::Id file = open_to_change(path);
  const std::vector<std::uint64_t> changed = replace_bytes(file, column, values);
  Json header = header_of(file);
  std::vector<std::uint64_t> hashes;
  const std::string old = OpenDataset(file, "chunk_hashes").bytes();
  const auto* from = reinterpret_cast<const std::uint64_t*>(old.data());
  for (const auto& [name, rows_and_chunks] : header["columns"].items()) {
    const auto chunks = rows_and_chunks[1].get<std::size_t>();
    if (name == column) {
      hashes.insert(hashes.end(), changed.begin(), changed.end());
      rows_and_chunks = {OpenDataset(file, column).size[0], changed.size()};
    } else {
      hashes.insert(hashes.end(), from, from + chunks);
    }
    from += chunks;
  }
  const auto bytes = std::as_bytes(std::span(hashes));
  replace_bytes(file, "chunk_hashes", bytes);
  header["chunk_hashes"] = xxh64(bytes);
  replace_header(file, indented_text(header, -1));
}
template <typename Values>
void change_column(const std::filesystem::path& path, const std::string& column,
                   const Values& values) {
  change_column_bytes(path, column, std::as_bytes(std::span(values)));
}

/// The values of a column.
template <typename Value>
std::vector<Value> values_of_column(const std::filesystem::path& path, const std::string& column) {
  const std::string bytes = OpenDataset(open_to_change(path), column).bytes();
  const auto* values = reinterpret_cast<const Value*>(bytes.data());
  return {values, values + bytes.size() / sizeof(Value)};
}

}  // namespace clearway::test
