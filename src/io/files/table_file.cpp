#include "io/files/table_file.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>

#include "clearway/error.hpp"
#include "io/files/file.hpp"
#include "io/files/fletcher32.hpp"
#include "io/files/hdf5.hpp"
#include "io/files/hdf5_detail.hpp"
#include "io/files/input_error.hpp"
#include "io/files/parallel_loop.hpp"
#include "io/files/thread_limit.hpp"
#include "io/files/xxh64.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t kMostChunkBytes = 1 << 18;
constexpr std::size_t kChecksumBytes = sizeof(std::uint32_t);

constexpr const char* kHeader = "header";
constexpr const char* kHeaderHash = "header_hash";
constexpr const char* kChunkHashes = "chunk_hashes";
constexpr const char* kColumns = "columns";
constexpr const char* kComplete = "complete";

hid_t file_type(NumberType type) {
  switch (type) {
    case NumberType::kUint8:
      return H5T_STD_U8LE;
    case NumberType::kUint16:
      return H5T_STD_U16LE;
    case NumberType::kInt32:
      return H5T_STD_I32LE;
    case NumberType::kUint32:
      return H5T_STD_U32LE;
    case NumberType::kInt64:
      return H5T_STD_I64LE;
    case NumberType::kUint64:
      return H5T_STD_U64LE;
    case NumberType::kFloat64:
      return H5T_IEEE_F64LE;
  }
  throw std::logic_error("no type of number");
}

/// Rows of a chunk: a power of two that divides kPieceRows, or all rows where these are fewer.
std::uint64_t rows_of_chunk(std::uint64_t rows, std::uint64_t value_bytes) {
  const std::uint64_t most =
      std::bit_floor(std::max<std::uint64_t>(1, kMostChunkBytes / value_bytes));
  return std::min<std::uint64_t>({rows, most, kPieceRows});
}

std::uint64_t chunks_of(std::uint64_t rows, std::uint64_t value_bytes) {
  return rows == 0 ? 0 : (rows - 1) / rows_of_chunk(rows, value_bytes) + 1;
}

std::string path_of(const std::string& group, const std::string& name) {
  return group.empty() ? name : group + "/" + name;
}

hdf5::Id create_dataset(const hdf5::Id& parent, const std::string& name, const TableColumn& column,
                        std::uint64_t rows) {
  const hdf5::Id space = hdf5::simple_space(rows, column.numbers);
  const hdf5::Id layout = hdf5::untimed(H5P_DATASET_CREATE);
  if (rows > 0) {
    const std::array<hsize_t, 2> chunk{rows_of_chunk(rows, column.value_bytes()), column.numbers};
    hdf5::check(H5Pset_chunk(layout.get(), column.numbers == 0 ? 1 : 2, chunk.data()),
                "HDF5 chunk size");
    hdf5::check(H5Pset_fletcher32(layout.get()), "HDF5 fletcher32");
  }
  return {H5Dcreate2(parent.get(), name.c_str(), file_type(column.type), space.get(), H5P_DEFAULT,
                     layout.get(), H5P_DEFAULT),
          H5Dclose, "create dataset " + name};
}

/// Writes a dataset that is no column: the header, or the hashes of the chunks.
template <typename Value>
void write_whole(const hdf5::Id& file, const char* name, std::span<const Value> values) {
  const TableColumn column = table_column<Value>(name);
  hdf5::Id dataset = create_dataset(file, name, column, values.size());
  if (values.empty()) return;
  hdf5::check(
      H5Dwrite(dataset.get(), file_type(column.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
      std::string("write ") + name);
  dataset.close(std::string("write ") + name);
}

/// Opens a dataset and checks its type and shape. rows: becomes its rows, which the file has room
/// for.
hdf5::Id open_checked(const hdf5::Id& file, const std::string& path, const TableColumn& form,
                      std::uint64_t file_bytes, const std::string& name, std::uint64_t& rows) {
  hdf5::Id dataset = hdf5::open_dataset(file, path, name);
  const hdf5::Id type(H5Dget_type(dataset.get()), H5Tclose, path);
  if (H5Tequal(type.get(), file_type(form.type)) <= 0) {
    hdf5::malformed(name, path, "numbers of the type written");
  }
  const hdf5::Id space(H5Dget_space(dataset.get()), H5Sclose, path);
  std::array<hsize_t, 2> size{0, form.numbers};
  const int dimensions = form.numbers == 0 ? 1 : 2;
  if (H5Sget_simple_extent_ndims(space.get()) != dimensions ||
      H5Sget_simple_extent_dims(space.get(), size.data(), nullptr) != dimensions ||
      size[1] != form.numbers) {
    hdf5::malformed(
        name, path,
        form.numbers == 0 ? "one dimension" : std::to_string(form.numbers) + " numbers a row");
  }
  rows = size[0];
  if (rows > file_bytes / form.value_bytes()) {
    hdf5::malformed(name, path, "no more rows than the file has room for");
  }
  const hdf5::Id list(H5Dget_create_plist(dataset.get()), H5Pclose, "HDF5 property list");
  std::array<hsize_t, 2> chunk{0, form.numbers};
  const bool as_written =
      rows == 0
          ? H5Pget_layout(list.get()) == H5D_CONTIGUOUS
          : H5Pget_layout(list.get()) == H5D_CHUNKED &&
                H5Pget_chunk(list.get(), dimensions, chunk.data()) == dimensions &&
                chunk[0] == rows_of_chunk(rows, form.value_bytes()) && chunk[1] == form.numbers;
  if (!as_written) hdf5::malformed(name, path, "chunks of rows, as Clearway writes them");
  return dataset;
}

/// Reads what write_whole() wrote.
template <typename Value>
std::vector<Value> read_whole(const hdf5::Id& file, const char* path, std::uint64_t file_bytes,
                              const std::string& name) {
  const TableColumn form = table_column<Value>(path);
  std::uint64_t rows = 0;
  const hdf5::Id dataset = open_checked(file, path, form, file_bytes, name, rows);
  std::vector<Value> values(rows);
  if (rows > 0 && H5Dread(dataset.get(), file_type(form.type), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                          values.data()) < 0) {
    hdf5::malformed(name, path, "intact data (" + hdf5::reason() + ")");
  }
  return values;
}

/// Calls `call` and turns a failure of HDF5 into an InputError: since the file could be opened, its
/// content must be damaged. Errors of system calls pass through.
template <typename Call>
auto as_input(const std::string& name, Call call) {
  const hdf5::QuietScope quiet;
  try {
    return call();
  } catch (const hdf5::Failure& error) {
    throw InputError(name + ": damaged: " + error.what());
  }
}

}  // namespace

std::size_t TableColumn::value_bytes() const {
  constexpr std::array<std::size_t, 7> kBytes{1, 2, 4, 4, 8, 8, 8};
  return kBytes[static_cast<std::size_t>(type)] * std::max<std::uint32_t>(numbers, 1);
}

void TablePiece::append(std::size_t rows, std::span<const ColumnBytes> columns) {
  if (columns.size() != columns_.size() || rows > kPieceRows - rows_) {
    throw std::logic_error("a piece of a table: too many rows, or other columns");
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    Column& column = columns_[i];
    ColumnBytes bytes = columns[i];
    if (bytes.size() != rows * column.value_bytes) {
      throw std::logic_error("a piece of a table: columns of unequal lengths");
    }
    while (!bytes.empty()) {
      if (column.chunks.empty() || column.chunks.back().used == column.chunk_bytes) {
        column.chunks.push_back(
            {std::make_unique_for_overwrite<std::byte[]>(column.chunk_bytes + kChecksumBytes)});
      }
      Chunk& chunk = column.chunks.back();
      const std::size_t count = std::min(bytes.size(), column.chunk_bytes - chunk.used);
      std::memcpy(chunk.bytes.get() + chunk.used, bytes.data(), count);
      chunk.used += count;
      bytes = bytes.subspan(count);
    }
  }
  rows_ += rows;
}

void TablePiece::seal() {
  for (Column& column : columns_) {
    for (Chunk& chunk : column.chunks) {
      const std::span all(chunk.bytes.get(), column.chunk_bytes + kChecksumBytes);
      std::ranges::fill(all.subspan(chunk.used), std::byte{0});
      seal_fletcher32(all);
      chunk.xxh64 = xxh64(all);
    }
  }
}

struct TableFileWriter::State {
  State(const std::filesystem::path& path, const TableFileKind& kind)
      : name(path.string()), file(hdf5::create_file(path)), output(File::open_for_writing(path)) {
    hdf5::write_attribute(file, "format", std::string(kind.format));
    hdf5::write_number(file, "version", kind.version);
  }

  /// Starts the transfer of what has been written to the disk, while the rest is computed.
  void written() {
    constexpr std::uint64_t kAtOnce = std::uint64_t{32} << 20;
    const std::uint64_t end = output.size_bytes();
    if (end < synced + kAtOnce) return;
    output.begin_sync(synced, end - synced);
    synced = end;
  }

  std::string name;
  hdf5::Id file;
  File output;                 ///< a second handle of the same file
  std::uint64_t synced = 0;    ///< bytes of the file that are on their way to the disk
  std::uint64_t promised = 0;  ///< bytes of all chunks of the tables
  std::deque<TableWriter> tables;
  std::size_t complete = 0;  ///< how many of them are
  Json columns = Json::object();
  std::vector<std::uint64_t> hashes;  ///< of the chunks of the tables that are complete
};

struct TableWriter::Dataset {
  hdf5::Id id;
  std::uint64_t chunk_rows = 0;
  std::uint64_t next_row = 0;
  std::vector<std::uint64_t> hashes = {};
};

TableWriter::TableWriter(TableFileWriter& file, std::string group, std::vector<TableColumn> columns,
                         std::uint64_t rows)
    : file_(file), group_(std::move(group)), columns_(std::move(columns)), promised_(rows) {
  TableFileWriter::State& state = *file_.state_;
  if (!group_.empty()) hdf5::require_group(state.file, group_);
  for (const TableColumn& column : columns_) {
    datasets_.push_back({create_dataset(state.file, path_of(group_, column.name), column, rows),
                         rows_of_chunk(rows, column.value_bytes())});
    state.promised += chunks_of(rows, column.value_bytes()) *
                      (datasets_.back().chunk_rows * column.value_bytes() + kChecksumBytes);
  }
  buffered_ = new_piece();
}

TableWriter::~TableWriter() = default;

TablePiece TableWriter::new_piece() const {
  TablePiece piece;
  for (const TableColumn& column : columns_) {
    const std::size_t bytes = column.value_bytes();
    piece.columns_.push_back({bytes, rows_of_chunk(promised_, bytes) * bytes});
  }
  return piece;
}

void TableWriter::write(TablePiece& piece) {
  begin_rows(piece.size());
  hdf5::naming(file_.state_->name, [&] { write_piece(piece); });
}

void TableWriter::begin_rows(std::size_t rows) {
  TableFileWriter::State& state = *file_.state_;
  hdf5::naming(state.name, [&] {
    while (state.complete < state.tables.size() && &state.tables[state.complete] != this) {
      state.tables[state.complete].complete();
    }
  });
  if (state.complete == state.tables.size() || rows > promised_ - written_ - buffered_.size()) {
    throw std::logic_error("/" + group_ + ": rows out of order, or too many of them");
  }
}

void TableWriter::write_piece(TablePiece& piece) {
  TableFileWriter::State& state = *file_.state_;
  if (piece.size() < kPieceRows && written_ + piece.size() < promised_) {
    throw std::logic_error("/" + group_ + ": rows in pieces of another length");
  }
  written_ += piece.size();
  for (std::size_t i = 0; i < datasets_.size(); ++i) {
    Dataset& dataset = datasets_[i];
    for (TablePiece::Chunk& chunk : piece.columns_[i].chunks) {
      const std::array<hsize_t, 2> at{dataset.next_row, 0};
      hdf5::check(H5Dwrite_chunk(dataset.id.get(), H5P_DEFAULT, 0, at.data(),
                                 piece.columns_[i].chunk_bytes + kChecksumBytes, chunk.bytes.get()),
                  "write dataset " + path_of(group_, columns_[i].name));
      dataset.next_row += dataset.chunk_rows;
      dataset.hashes.push_back(chunk.xxh64);
      chunk.bytes.reset();
    }
  }
  state.written();
}

void TableWriter::append(std::size_t rows, std::span<const ColumnBytes> columns) {
  begin_rows(rows);
  std::vector<ColumnBytes> part(columns.begin(), columns.end());
  for (std::size_t first = 0; first < rows;) {
    const std::size_t count = std::min(rows - first, kPieceRows - buffered_.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t bytes = columns_.at(i).value_bytes();
      if (columns[i].size() != rows * bytes) {
        throw std::logic_error("/" + group_ + ": columns of unequal lengths");
      }
      part[i] = columns[i].subspan(first * bytes, count * bytes);
    }
    buffered_.append(count, part);
    first += count;
    if (buffered_.size() < kPieceRows && written_ + buffered_.size() < promised_) continue;
    TablePiece piece = std::exchange(buffered_, new_piece());
    piece.seal();
    write(piece);
  }
}

void TableWriter::complete() {
  if (written_ != promised_) {
    throw std::logic_error("/" + group_ + ": " + std::to_string(written_) + " rows written, " +
                           std::to_string(promised_) + " promised");
  }
  TableFileWriter::State& state = *file_.state_;
  for (std::size_t i = 0; i < datasets_.size(); ++i) {
    const std::string path = path_of(group_, columns_[i].name);
    datasets_[i].id.close("write dataset " + path);
    const std::vector<std::uint64_t>& hashes = datasets_[i].hashes;
    state.columns[path] = {promised_, hashes.size()};
    state.hashes.insert(state.hashes.end(), hashes.begin(), hashes.end());
  }
  ++state.complete;
}

TableFileWriter::TableFileWriter(const std::filesystem::path& path, const TableFileKind& kind)
    : state_(hdf5::naming(path.string(), [&] { return std::make_unique<State>(path, kind); })) {}

TableFileWriter::~TableFileWriter() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

TableWriter& TableFileWriter::add_table(std::string group, std::vector<TableColumn> columns,
                                        std::uint64_t rows) {
  return hdf5::naming(state_->name, [&]() -> TableWriter& {
    TableWriter& table =
        state_->tables.emplace_back(*this, std::move(group), std::move(columns), rows);
    state_->output.reserve_ahead(state_->promised);
    return table;
  });
}

void TableFileWriter::note(const char* attribute, std::span<const double> numbers) {
  hdf5::naming(state_->name, [&] {
    hdf5::write_attribute(state_->file, attribute, H5T_IEEE_F64LE, numbers.size(), numbers.data());
  });
}

void TableFileWriter::note(const char* attribute, bool flag) {
  hdf5::naming(state_->name,
               [&] { hdf5::write_number(state_->file, attribute, std::uint8_t{flag}); });
}

void TableFileWriter::finish(Json facts) {
  State& s = *state_;
  hdf5::naming(s.name, [&] {
    while (s.complete < s.tables.size()) s.tables[s.complete].complete();
    facts[kColumns] = s.columns;
    facts[kChunkHashes] = xxh64(std::as_bytes(std::span(s.hashes)));
    const std::string text = indented_text(facts, -1);
    const std::vector<std::uint8_t> header(text.begin(), text.end());
    write_whole<std::uint64_t>(s.file, kChunkHashes, s.hashes);
    write_whole<std::uint8_t>(s.file, kHeader, header);
    hdf5::write_number(s.file, kHeaderHash, xxh64(std::as_bytes(std::span(header))));
    hdf5::write_number(s.file, kComplete, std::uint8_t{1});
    hdf5::check(H5Fflush(s.file.get(), H5F_SCOPE_LOCAL), "write the file");
    // After the flush, closing has nothing left to write and cannot fail for a full disk.
    s.file.close("close the file");
  });
}

const hdf5::Id& TableFileWriter::file() const { return state_->file; }
void TableFileWriter::written() { state_->written(); }

struct TableFile::State {
  State(const std::filesystem::path& path, std::span<const TableFileKind> kinds)
      : name(path.string()),
        file(hdf5::open_file(path)),
        bytes(std::make_shared<File>(File::open_regular(path))),
        kind(kind_of(kinds)) {
    read_header();
    read_chunk_hashes();
  }

  std::size_t kind_of(std::span<const TableFileKind> kinds) const {
    const std::string format = hdf5::has_attribute(file, "format", name)
                                   ? hdf5::read_text_attribute(file, "format", name)
                                   : "";
    const auto found = std::ranges::find(kinds, format, &TableFileKind::format);
    if (found == kinds.end()) {
      refuse(name,
             std::string("is not ") + kinds[0].is_a + "; expected a file of " + kinds[0].made_by);
    }
    const auto version = hdf5::read_number<std::uint32_t>(file, "version", name);
    if (version != found->version) {
      refuse(name, std::string("is ") + found->is_a + " of version " + std::to_string(version) +
                       " of another release; " + found->again);
    }
    if (!hdf5::has_attribute(file, kComplete, name) ||
        hdf5::read_number<std::uint8_t>(file, kComplete, name) != 1) {
      refuse(name, std::string("is not complete: the command that wrote it was interrupted; ") +
                       found->again);
    }
    return static_cast<std::size_t>(found - kinds.begin());
  }

  void read_header() {
    const auto text = read_whole<std::uint8_t>(file, kHeader, bytes->size_bytes(), name);
    if (xxh64(std::as_bytes(std::span(text))) !=
        hdf5::read_number<std::uint64_t>(file, kHeaderHash, name)) {
      refuse(name, "its header is damaged (its hash is not the one recorded)");
    }
    try {
      header = parse_json({reinterpret_cast<const char*>(text.data()), text.size()});
    } catch (const JsonError& error) {
      refuse(name, std::string("its header ") + error.what());
    }
    if (!header.is_object()) refuse(name, "its header is no object");
  }

  void read_chunk_hashes() {
    hashes = read_whole<std::uint64_t>(file, kChunkHashes, bytes->size_bytes(), name);
    const Json listed = header.value(kColumns, Json());
    bool sound = listed.is_object() &&
                 header.value(kChunkHashes, Json()) == xxh64(std::as_bytes(std::span(hashes)));
    std::uint64_t chunks = 0;
    for (const auto& [path, column] : listed.items()) {
      sound = sound && column.is_array() && column.size() == 2 && column[0].is_number_unsigned() &&
              column[1].is_number_unsigned() &&
              column[1].get<std::uint64_t>() <= hashes.size() - chunks;
      if (!sound) break;
      columns.emplace(path, Recorded{column[0], std::span(hashes).subspan(chunks, column[1])});
      chunks += column[1].get<std::uint64_t>();
    }
    if (sound && chunks == hashes.size()) return;
    refuse(name, "its chunk hashes are damaged (their hash is not the one recorded)");
  }

  struct Recorded {
    std::uint64_t rows;
    std::span<const std::uint64_t> hashes;
  };

  std::string name;
  hdf5::Id file;
  std::shared_ptr<const File> bytes;  ///< the same file, read by many threads
  std::size_t kind;
  Json header;
  std::vector<std::uint64_t> hashes;
  std::map<std::string, Recorded, std::less<>> columns;
};

struct StoredColumn::Source {
  ~Source() {
    const hdf5::QuietScope quiet;
    dataset = {};
  }

  std::string name, path;
  hdf5::Id dataset;
  std::shared_ptr<const File> bytes;
  std::size_t value_bytes;
  std::uint64_t chunk_rows;
  std::vector<std::uint64_t> hashes;

  std::size_t stored_bytes() const { return chunk_rows * value_bytes + kChecksumBytes; }

  [[noreturn]] void refuse_chunk(std::uint64_t chunk, const char* why) const {
    refuse(name, "/" + path + ": its rows from " + std::to_string(chunk * chunk_rows) +
                     " on are damaged (" + why + ")");
  }

  /// Where a chunk begins in the file.
  std::uint64_t address(std::uint64_t chunk) const {
    const std::array<hsize_t, 2> at{chunk * chunk_rows, 0};
    unsigned left_out = 0;
    haddr_t begin = 0;
    hsize_t size = 0;
    if (H5Dget_chunk_info_by_coord(dataset.get(), at.data(), &left_out, &begin, &size) < 0 ||
        left_out != 0 || size != stored_bytes() || begin > bytes->size_bytes() ||
        size > bytes->size_bytes() - begin) {
      refuse_chunk(chunk, "their chunk is not where it was written");
    }
    return begin;
  }

  void check_hash(std::uint64_t chunk, std::uint64_t found) const {
    if (found != hashes[chunk]) refuse_chunk(chunk, "their hash is not the one recorded");
  }

  /// Reads the rows of a chunk from `skipped` on into `out`.
  void read_chunk(std::uint64_t chunk, std::uint64_t begin, std::size_t skipped,
                  std::span<std::byte> out) const {
    if (skipped == 0) {  // what follows is padding and the checksum, unless only a part is wanted
      std::vector<std::byte> rest(stored_bytes() - out.size());
      bytes->read_at(begin, out);
      bytes->read_at(begin + out.size(), rest);
      Xxh64Stream hash;
      hash.update(out);
      hash.update(rest);
      return check_hash(chunk, hash.digest());
    }
    std::vector<std::byte> all(stored_bytes());
    bytes->read_at(begin, all);
    check_hash(chunk, xxh64(all));
    std::memcpy(out.data(), all.data() + skipped * value_bytes, out.size());
  }
};

std::uint64_t StoredColumn::hash() const {
  return xxh64(std::as_bytes(std::span(source_->hashes)));
}

void StoredColumn::read_bytes(std::uint64_t first, std::span<std::byte> out,
                              const Check& check) const {
  if (out.empty()) return;
  const Source& source = *source_;
  const std::uint64_t end = first + out.size() / source.value_bytes;
  if (end > rows_ || end < first) throw std::logic_error("rows past the end of a table");
  const std::uint64_t first_chunk = first / source.chunk_rows;
  std::vector<std::uint64_t> begins;
  as_input(source.name, [&] {
    for (std::uint64_t c = first_chunk; c * source.chunk_rows < end; ++c) {
      begins.push_back(source.address(c));
    }
  });
  std::mutex mutex;
  std::size_t failed = begins.size();
  std::exception_ptr failure;
  const auto read_one = [&](std::size_t i) {
    const std::uint64_t chunk = first_chunk + i;
    const std::uint64_t from = std::max(first, chunk * source.chunk_rows);
    const std::uint64_t to = std::min(end, (chunk + 1) * source.chunk_rows);
    const auto part =
        out.subspan((from - first) * source.value_bytes, (to - from) * source.value_bytes);
    try {
      source.read_chunk(chunk, begins[i], from - chunk * source.chunk_rows, part);
      if (check) check(from, part);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (i < failed) failure = std::current_exception();
      failed = std::min(failed, i);
    }
  };
  if (begins.size() == 1) {
    read_one(0);
  } else {
    in_all_threads([&] { for_each_parallel(begins.size(), read_one); });
  }
  if (failure) std::rethrow_exception(failure);
}

TableFile::TableFile(const std::filesystem::path& path, std::span<const TableFileKind> kinds)
    : state_(as_input(path.string(), [&] { return std::make_unique<State>(path, kinds); })) {}

TableFile::TableFile(TableFile&&) noexcept = default;

TableFile& TableFile::operator=(TableFile&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

TableFile::~TableFile() {
  const hdf5::QuietScope quiet;
  state_.reset();
}

const std::string& TableFile::name() const { return state_->name; }
std::size_t TableFile::kind() const { return state_->kind; }
const Json& TableFile::header() const { return state_->header; }
const hdf5::Id& TableFile::file() const { return state_->file; }

StoredColumn TableFile::open(const std::string& path, const TableColumn& form) const {
  return as_input(name(), [&] {
    const auto recorded = state_->columns.find(path);
    if (recorded == state_->columns.end()) refuse(name(), "/" + path + " is missing");
    StoredColumn column;
    const auto source = std::make_shared<StoredColumn::Source>();
    source->dataset =
        open_checked(state_->file, path, form, state_->bytes->size_bytes(), name(), column.rows_);
    source->name = name();
    source->path = path;
    source->bytes = state_->bytes;
    source->value_bytes = form.value_bytes();
    source->chunk_rows = rows_of_chunk(column.rows_, form.value_bytes());
    const auto& [rows, hashes] = recorded->second;
    source->hashes.assign(hashes.begin(), hashes.end());
    if (rows != column.rows_ || hashes.size() != chunks_of(rows, form.value_bytes())) {
      refuse(name(), "/" + path + ": has other rows than its header says");
    }
    column.source_ = source;
    return column;
  });
}

}  // namespace clearway
