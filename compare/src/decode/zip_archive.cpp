#include "decode/zip_archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/input_file.hpp"
#include "base/quote.hpp"
#include "decode/binary.hpp"
#include "decode/inflate.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

// PKWARE's APPNOTE.TXT, 4.3: signatures, lengths of the fixed parts, and where in them what is.
constexpr std::string_view end_signature = "PK\x05\x06";
constexpr std::string_view directory_signature = "PK\x01\x02";
constexpr std::string_view local_signature = std::string_view("PK\x03\x04");
constexpr std::size_t end_length = 22;
constexpr std::size_t directory_length = 46;
constexpr std::size_t local_length = 30;
/// More than anybody saves arrays in one file.
constexpr std::size_t most_entries = 1000;

}  // namespace

void ZipArchive::fail(const std::string& problem) const {
  throw InputError(fmt::format("{}: {}", file_, problem));
}

ZipArchive::ZipArchive(std::string_view bytes, std::string file) : file_(std::move(file)) {
  const std::size_t end = bytes.rfind(end_signature);
  if (end == std::string_view::npos || bytes.size() - end < end_length) {
    fail("a zip archive that is cut off: it has no directory");
  }
  const std::size_t count = natural_at(bytes, end + 10, 2).value();
  if (count > most_entries) {
    fail(fmt::format("a zip archive of {} entries (allowed: 1 to {})", count, most_entries));
  }
  std::size_t at = natural_at(bytes, end + 16, 4).value();
  for (std::size_t i = 0; i < count; ++i) at = add_entry(bytes, at);
  std::size_t total = 0;
  for (const Entry& entry : entries_) total += entry.size;
  if (total > InputFile::largest_file) {
    fail(fmt::format("a zip archive of {} bytes when inflated (allowed: up to {})", total,
                     InputFile::largest_file));
  }
}

std::size_t ZipArchive::add_entry(std::string_view bytes, std::size_t at) {
  const auto field = [&](std::size_t where, std::size_t size) {
    const auto value = natural_at(bytes, where, size);
    if (!value) fail("a zip archive that is cut off, or damaged");
    return static_cast<std::size_t>(*value);
  };
  if (at > bytes.size() || !bytes.substr(at).starts_with(directory_signature)) {
    fail("a zip archive with a damaged directory");
  }
  Entry entry;
  const std::size_t name_length = field(at + 28, 2);
  const std::size_t next =
      at + directory_length + name_length + field(at + 30, 2) + field(at + 32, 2);
  if (next > bytes.size()) fail("a zip archive that is cut off in its directory");
  entry.name = bytes.substr(at + directory_length, name_length);
  const std::size_t packed = field(at + 20, 4);
  entry.size = field(at + 24, 4);
  entry.crc_ = field(at + 16, 4);
  const std::string name = quoted_piece(entry.name);
  const bool encrypted = field(at + 8, 2) % 2 == 1;
  const std::size_t method = field(at + 10, 2);
  if (encrypted || (method != 0 && method != 8)) {
    fail(
        fmt::format("entry {} is {} (allowed: stored or deflated, as numpy.savez and "
                    "numpy.savez_compressed do)",
                    name, encrypted ? "encrypted" : fmt::format("packed by method {}", method)));
  }
  entry.deflated_ = method == 8;
  if (entry.size > InputFile::largest_file || packed > bytes.size()) {
    fail(fmt::format("entry {} has {} bytes, {} packed (allowed: up to {}, in the file)", name,
                     entry.size, packed, InputFile::largest_file));
  }
  const std::size_t local = field(at + 42, 4);
  if (local > bytes.size() || !bytes.substr(local).starts_with(local_signature)) {
    fail(fmt::format("entry {} is not where the directory says", name));
  }
  const std::size_t begin = local + local_length + field(local + 26, 2) + field(local + 28, 2);
  if (begin > bytes.size() || bytes.size() - begin < packed) {
    fail(fmt::format("entry {} is cut off", name));
  }
  entry.bytes_ = bytes.substr(begin, packed);
  entries_.push_back(std::move(entry));
  return next;
}

std::string ZipArchive::read(const Entry& entry) const {
  const auto bytes = entry.deflated_ ? inflated(entry.bytes_, entry.size, Deflated::raw)
                                     : std::optional<std::string>(entry.bytes_);
  if (!bytes || bytes->size() != entry.size || crc_of(*bytes) != entry.crc_) {
    fail(fmt::format("entry {} is damaged", quoted_piece(entry.name)));
  }
  return *bytes;
}

std::string ZipArchive::read_start(const Entry& entry, std::size_t most) const {
  const std::size_t size = std::min(most, entry.size);
  if (!entry.deflated_) return std::string(entry.bytes_.substr(0, size));
  const auto bytes = inflated(entry.bytes_, size, Deflated::raw, true);
  if (!bytes) fail(fmt::format("entry {} is damaged", quoted_piece(entry.name)));
  return *bytes;
}

}  // namespace dlo::compare
