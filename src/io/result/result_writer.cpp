#include "io/result/result.hpp"

namespace clearway {
ResultWriter::ResultWriter(const std::filesystem::path& path, const ResultHeader& header,
                           std::uint64_t collisions, std::uint64_t clearances, std::uint64_t near,
                           std::uint64_t unseen, std::uint64_t swept)
    : header_(header), file_(path, kResultKinds[header.part ? 1 : 0]) {
  begin<Collisions>(collisions);
  begin<Clearances>(clearances);
  begin<ProfileRows>(header.poses);
  begin<Nearby>(near);
  begin<UnseenCubes>(unseen);
  begin<SweptCells>(swept);
  file_.note("scale", std::span<const double>(header_.quantisation.scale));
  file_.note("offset", std::span<const double>(header_.quantisation.offset));
  file_.note("radius", std::span(&header_.radius, 1));
  file_.note("first_pose", header_.first_pose);
}

template <typename Rows>
void ResultWriter::begin(std::uint64_t rows) {
  if (!Table<Rows>::is_in(header_)) return;
  std::vector<TableColumn> columns;
  for_each_column<Rows>([&](const auto& column) {
    using Value = typename std::decay_t<decltype(column)>::Value;
    if (column.is_in(header_)) columns.push_back(table_column<Value>(column.dataset));
  });
  std::get<Written<Rows>>(tables_).table =
      &file_.add_table(Table<Rows>::kGroup, std::move(columns), rows);
}

void ResultWriter::finish(const ResultFindings& findings) {
  file_.finish(result_facts(header_, findings));
}

}  // namespace clearway
