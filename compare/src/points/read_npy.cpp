#include "points/read_npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "decode/binary.hpp"
#include "decode/zip_archive.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/shape_file.hpp"
#include "points/shape_name.hpp"

namespace dlo::compare {
namespace {

/// Of a header; numpy's own are below 200 bytes, but for structured arrays.
constexpr std::size_t longest_header = 10'000;
constexpr const char* arrays_allowed = "(allowed: N x 3 or N x 2)";

/// An array's header.
struct Header {
  std::string type;  ///< as numpy writes it, such as <f8
  bool by_columns = false;
  std::vector<std::size_t> shape;
  std::size_t begin = 0;  ///< of the numbers
};

/// Reads the header of an array, a Python dictionary of three keys.
class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, std::string name) : name_(std::move(name)) {
    constexpr std::size_t before_length = 8;
    const std::uint64_t version = natural_at(bytes, npy_magic.size(), 1).value_or(0);
    const std::size_t width = version == 1 ? 2 : 4;
    const std::optional<std::uint64_t> length = natural_at(bytes, before_length, width);
    if (!bytes.starts_with(npy_magic) || version < 1 || version > 3 || !length) {
      fail("not an array as NumPy saves it, of format 1, 2 or 3");
    }
    header_.begin = before_length + width + *length;
    if (*length > longest_header || header_.begin > bytes.size()) {
      fail(fmt::format("a header of {} bytes (allowed: up to {}, in the file)", *length,
                       longest_header));
    }
    text_ = bytes.substr(before_length + width, *length);
  }

  [[nodiscard]] Header read() {
    read_type(after("descr"));
    const std::string_view order = after("fortran_order");
    header_.by_columns = order.starts_with("True");
    if (!header_.by_columns && !order.starts_with("False")) fail("a damaged header");
    read_shape(after("shape"));
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}: {}", name_, problem));
  }

  /// What is behind a key and its colon.
  [[nodiscard]] std::string_view after(const std::string& key) const {
    const std::size_t at = text_.find("'" + key + "'");
    const std::size_t colon = at == std::string_view::npos ? at : text_.find(':', at);
    const std::size_t value =
        colon == std::string_view::npos ? colon : text_.find_first_not_of(' ', colon + 1);
    if (value == std::string_view::npos) fail(fmt::format("a header without {}", key));
    return text_.substr(value);
  }

  void read_type(std::string_view value) {
    if (value.front() == '[') fail("a structured array (allowed: one of plain numbers)");
    const std::size_t end = value.find('\'', 1);
    if (value.front() != '\'' || end == std::string_view::npos) fail("a damaged header");
    header_.type = value.substr(1, end - 1);
  }

  void read_shape(std::string_view value) {
    const std::size_t end = value.find(')');
    if (value.front() != '(' || end == std::string_view::npos) fail("a damaged header");
    value = value.substr(1, end - 1);
    while (!value.empty()) {
      const std::size_t comma = std::min(value.find(','), value.size());
      std::string_view part = value.substr(0, comma);
      value.remove_prefix(std::min(comma + 1, value.size()));
      part.remove_prefix(std::min(part.find_first_not_of(' '), part.size()));
      part = part.substr(0, part.find_last_not_of(' ') + 1);
      if (part.empty() && value.empty()) break;
      const std::optional<std::size_t> size = as_number<std::size_t>(part);
      if (!size) fail(fmt::format("a shape with {} in it", quoted_piece(part)));
      header_.shape.push_back(*size);
    }
  }

  std::string name_;
  std::string_view text_;
  Header header_;
};

/// Of the types that are read; none of another.
std::optional<NumberFormat> format_of(std::string_view type) {
  NumberFormat format;
  if (type.size() != 3 || std::string_view("<>|=").find(type[0]) == std::string_view::npos) {
    return std::nullopt;
  }
  format.big_endian = type[0] == '>';
  format.bytes = static_cast<std::size_t>(type[2] - '0');
  switch (type[1]) {
    case 'f':
      format.kind = NumberFormat::Kind::floating;
      break;
    case 'i':
      format.kind = NumberFormat::Kind::integer;
      break;
    case 'u':
      format.kind = NumberFormat::Kind::natural;
      break;
    default:
      return std::nullopt;
  }
  return is_known(format) ? std::optional(format) : std::nullopt;
}

std::string shape_text(const Header& header) {
  return header.shape.empty() ? "a single number"
                              : fmt::format("{}", fmt::join(header.shape, " x "));
}

/// Whether an array's shape is one of points, or of frames of them.
bool has_points(const Header& header) {
  const std::vector<std::size_t>& n = header.shape;
  if (!format_of(header.type) || (n.size() != 2 && n.size() != 3)) return false;
  return n.back() == 2 || n.back() == 3;
}

/// Where the numbers of a frame's points are.
struct FrameLayout {
  std::size_t points = 0, coordinates = 0;
  std::size_t first = 0;  ///< of the frame
  std::size_t of_point = 0, of_coordinate = 0;
};

/// An array to be read: its bytes, header and names.
class Array {
 public:
  /// @param where  for messages
  Array(std::string_view bytes, std::string where, ShapeName name)
      : bytes_(bytes),
        where_(std::move(where)),
        name_(std::move(name)),
        header_(HeaderReader(bytes, where_).read()) {}

  [[nodiscard]] RawShape read() const {
    const std::optional<NumberFormat> format = format_of(header_.type);
    if (!format) {
      fail(
          fmt::format("numbers of the type {} (allowed: integers and floating-point numbers of "
                      "32 and 64 bits, such as <f8)",
                      quoted_piece(header_.type)));
    }
    require_size(format->bytes);
    const FrameLayout at = layout();
    RawShape raw;
    raw.points.reserve(at.points);
    for (std::size_t i = 0; i < at.points; ++i) {
      std::array<double, 3> point{};
      for (std::size_t k = 0; k < at.coordinates; ++k) {
        const std::size_t number = at.first + i * at.of_point + k * at.of_coordinate;
        point[k] =
            numbers_from(bytes_.substr(header_.begin + number * format->bytes), 1, *format).front();
      }
      raw.points.push_back(point);
    }
    return raw;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}: {}", where_, problem));
  }

  void require_size(std::size_t number) const {
    // No dimension and no product of them can overflow where each is held against the file's size.
    std::size_t bytes = number;
    for (const std::size_t size : header_.shape) {
      if (size > InputFile::largest_file) fail(too_large());
      bytes *= size;
      if (bytes > InputFile::largest_file) fail(too_large());
    }
    const std::size_t there = bytes_.size() - header_.begin;
    if (there == bytes) return;
    fail(fmt::format("{} numbers of {} bytes are {} bytes, and {} are there: {}",
                     shape_text(header_), number, bytes, there,
                     there < bytes ? "the file is cut off" : "more than one array"));
  }

  [[nodiscard]] std::string too_large() const {
    return fmt::format("{} numbers (allowed: files of up to {} bytes)", shape_text(header_),
                       InputFile::largest_file);
  }

  [[nodiscard]] FrameLayout layout() const {
    const std::vector<std::size_t>& n = header_.shape;
    if (n.size() == 3 && (n[2] == 2 || n[2] == 3)) return frame_layout();
    if (n.size() != 2 || (n[1] != 2 && n[1] != 3)) {
      const bool lying = n.size() == 2 && (n[0] == 2 || n[0] == 3);
      fail(fmt::format("an array of {} {}{}", shape_text(header_), arrays_allowed,
                       lying ? "; numpy.save its transpose" : ""));
    }
    if (!name_.index.empty()) {
      fail(fmt::format("has no frames to choose {} from (allowed: {} alone)",
                       quoted_piece(name_.index), chosen("")));
    }
    require_point_count(n[0], where_);
    if (header_.by_columns) return {n[0], n[1], 0, 1, n[0]};
    return {n[0], n[1], 0, n[1], 1};
  }

  [[nodiscard]] FrameLayout frame_layout() const {
    const std::vector<std::size_t>& n = header_.shape;
    const auto frames = static_cast<std::int64_t>(n[0]);
    const std::optional<std::int64_t> index = as_number<std::int64_t>(name_.index);
    if (!index || *index >= frames || *index < -frames) {
      fail(fmt::format(
          "{} frames of {} points{} (allowed: one of them, as {} for the first and {} "
          "for the last)",
          n[0], n[1], name_.index.empty() ? "" : ", no frame " + quoted_piece(name_.index),
          chosen("0"), chosen("-1")));
    }
    require_point_count(n[1], where_);
    const auto frame = static_cast<std::size_t>(*index < 0 ? *index + frames : *index);
    if (header_.by_columns) return {n[1], n[2], frame, n[0], n[0] * n[1]};
    return {n[1], n[2], frame * n[1] * n[2], n[2], 1};
  }

  /// The name by which a frame is asked for.
  [[nodiscard]] std::string chosen(const char* index) const {
    const std::string array =
        name_.key.empty() ? name_.file : fmt::format("{}:{}", name_.file, name_.key);
    return *index == '\0' ? array : fmt::format("{}:{}", array, index);
  }

  std::string_view bytes_;
  std::string where_;
  ShapeName name_;
  Header header_;
};

/// As numpy knows an entry.
std::string key_of(const ZipArchive::Entry& entry) {
  constexpr std::string_view suffix = ".npy";
  std::string key = entry.name;
  if (key.ends_with(suffix)) key.resize(key.size() - suffix.size());
  return key;
}

/// Of the only array of points in an archive. @throws InputError listing what is there
const ZipArchive::Entry& only_points(const ZipArchive& archive, const std::string& file) {
  std::vector<std::string> names;
  std::string example;
  const ZipArchive::Entry* found = nullptr;
  int points = 0;
  for (const ZipArchive::Entry& entry : archive.entries()) {
    const std::string start = archive.read_start(entry, longest_header + npy_magic.size() + 6);
    if (!start.starts_with(npy_magic)) continue;
    const std::string where = fmt::format("{}: entry {}", file, quoted_piece(entry.name));
    const Header header = HeaderReader(start, where).read();
    constexpr std::size_t most_named = 8;
    if (names.size() < most_named) {
      names.push_back(fmt::format("{} ({})", quoted_piece(key_of(entry)), shape_text(header)));
    }
    if (!has_points(header)) continue;
    ++points;
    if (found == nullptr) found = &entry;
  }
  if (points == 1) return *found;
  if (points == 0) {
    throw InputError(fmt::format("{}: no array of points {}{}", file, arrays_allowed,
                                 names.empty() ? "" : fmt::format(": {}", fmt::join(names, ", "))));
  }
  throw InputError(fmt::format("{0}: several arrays: {1} (allowed: one of them, as {0}:{2})", file,
                               fmt::join(names, ", "), printable_piece(key_of(*found))));
}

const ZipArchive::Entry& entry_of(const ZipArchive& archive, const ShapeName& name,
                                  const std::string& file) {
  if (name.key.empty()) return only_points(archive, file);
  std::vector<std::string> keys;
  for (const ZipArchive::Entry& entry : archive.entries()) {
    if (key_of(entry) == name.key) return entry;
    constexpr std::size_t most_named = 8;
    if (keys.size() < most_named) keys.push_back(quoted_piece(key_of(entry)));
  }
  throw InputError(fmt::format("{}: no array {} (allowed: {})", file, quoted_piece(name.key),
                               fmt::join(keys, ", ")));
}

}  // namespace

RawShape read_npy_shape(std::string_view bytes, const std::string& file) {
  return Array(bytes, file, shape_name(file)).read();
}

RawShape read_npz_shape(std::string_view bytes, const std::string& file) {
  ShapeName name = shape_name(file);
  const ZipArchive archive(bytes, file);
  const ZipArchive::Entry& entry = entry_of(archive, name, file);
  const std::string array = archive.read(entry);
  const bool was_asked = !name.key.empty();
  name.key = printable_piece(key_of(entry));
  return Array(array, was_asked ? file : fmt::format("{}: array {}", file, name.key),
               std::move(name))
      .read();
}

}  // namespace dlo::compare
