#include <algorithm>
#include <utility>

#include "io/hdf5/hdf5_detail.hpp"

namespace clearway::hdf5 {
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

template <typename Number>
void write_attribute(const Id& object, const std::string& name, std::span<const Number> values,
                     std::uint64_t columns) {
  const Id space = simple_space(values.size() / std::max<std::uint64_t>(columns, 1), columns);
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

bool has_attribute(const Id& object, const std::string& name, const std::string& file) {
  const htri_t found = H5Aexists(object.get(), name.c_str());
  if (found < 0) malformed(file, name, "intact attributes (" + reason() + ")");
  return found > 0;
}

template <typename Number>
std::vector<Number> read_attribute(const Id& object, const std::string& name, std::size_t count,
                                   const std::string& file) {
  const auto [attribute, type, numbers] = open_attribute(object, name, file);
  if (H5Tequal(type.get(), file_type<Number>()) <= 0 || numbers != static_cast<hssize_t>(count)) {
    malformed(file, name, std::to_string(count) + " numbers of the type written");
  }
  std::vector<Number> values(count);
  check(H5Aread(attribute.get(), memory_type<Number>(), values.data()), file + ": read " + name);
  return values;
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

#define CLEARWAY_INSTANTIATE(Number)                                                      \
  template void write_attribute(const Id&, const std::string&, std::span<const Number>,   \
                                std::uint64_t);                                           \
  template std::vector<Number> read_attribute(const Id&, const std::string&, std::size_t, \
                                              const std::string&);

CLEARWAY_INSTANTIATE(std::uint8_t)
CLEARWAY_INSTANTIATE(std::uint16_t)
CLEARWAY_INSTANTIATE(std::int32_t)
CLEARWAY_INSTANTIATE(std::uint32_t)
CLEARWAY_INSTANTIATE(std::uint64_t)
CLEARWAY_INSTANTIATE(double)
#undef CLEARWAY_INSTANTIATE

}  // namespace clearway::hdf5
