#include "io/conflicts/bcf/zip_writer.hpp"

#include <zlib.h>

#include "clearway/error.hpp"
#include "io/conflicts/bcf/deflated.hpp"

namespace clearway {
namespace {

constexpr std::uint32_t kMostMembers = 65'534;
constexpr std::uint64_t kMostBytes = 0xffff'fffe;
constexpr std::uint16_t kVersion = 20, kStored = 0, kDeflated = 8;
constexpr std::uint16_t kMidnight = 0, kFirstDay = (0 << 9) | (1 << 5) | 1;  // 1980-01-01

void put16(std::string& out, std::uint64_t value) {
  out += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8 & 0xff)};
}

void put32(std::string& out, std::uint64_t value) {
  put16(out, value & 0xffff);
  put16(out, value >> 16 & 0xffff);
}

/// The fields that a member's own header and its entry in the directory share.
std::string description_of(std::string_view bytes, std::size_t packed, std::uint16_t method,
                           std::size_t name) {
  std::string out;
  put16(out, kVersion);
  put16(out, 0);  // flags
  put16(out, method);
  put16(out, kMidnight);
  put16(out, kFirstDay);
  put32(out, crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  put32(out, packed);
  put32(out, bytes.size());
  put16(out, name);
  put16(out, 0);  // extra field
  return out;
}

}  // namespace

void ZipWriter::add(const std::string& name, std::string_view bytes) {
  std::string packed = deflated(bytes, DeflateForm::kRaw);
  const bool smaller = packed.size() < bytes.size();
  const std::string_view body = smaller ? packed : bytes;
  if (members_ == kMostMembers || written_ + directory_.size() + body.size() + 1024 > kMostBytes) {
    throw UsageError(file_.name() +
                     ": more than a ZIP archive holds; expected fewer conflicts, for example by "
                     "more points for the smallest one");
  }
  const std::string description =
      description_of(bytes, body.size(), smaller ? kDeflated : kStored, name.size());
  const std::uint64_t at = written_;
  std::string header;
  put32(header, 0x04034b50);
  write(header + description + name);
  write(body);
  put32(directory_, 0x02014b50);
  put16(directory_, kVersion);
  directory_ += description;
  put16(directory_, 0);  // comment
  put16(directory_, 0);  // disk
  put16(directory_, 0);  // internal attributes
  put32(directory_, 0);  // external attributes
  put32(directory_, at);
  directory_ += name;
  ++members_;
}

void ZipWriter::finish() {
  const std::uint64_t at = written_;
  write(directory_);
  std::string end;
  put32(end, 0x06054b50);
  put32(end, 0);  // disks
  put16(end, members_);
  put16(end, members_);
  put32(end, directory_.size());
  put32(end, at);
  put16(end, 0);  // comment
  write(end);
}

void ZipWriter::write(std::string_view bytes) {
  file_.write(std::as_bytes(std::span(bytes)));
  written_ += bytes.size();
}

}  // namespace clearway
