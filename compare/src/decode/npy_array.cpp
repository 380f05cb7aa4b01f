#include "decode/npy_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Largest size of a header [bytes]; those of numpy are below 200 bytes, except for structured
/// arrays.
constexpr std::size_t longest_header = 10'000;

/// Header of an array.
struct Header {
  std::string type;  ///< as numpy writes it, such as <f8
  bool by_columns = false;
  std::vector<std::size_t> shape;
  std::size_t begin = 0;  ///< start of the numbers
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

  /// Returns the text behind a key and its colon.
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

/// Returns the number format of a type; empty if it is not supported.
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

std::string too_large(const NpyArray& array) {
  return fmt::format("{} numbers (allowed: files of up to {} bytes)", array.shape_text(),
                     InputFile::largest_file);
}

}  // namespace

NpyArray::NpyArray(std::string_view bytes, std::string where)
    : bytes_(bytes), where_(std::move(where)) {
  Header header = HeaderReader(bytes, where_).read();
  format_ = format_of(header.type);
  type_ = std::move(header.type);
  by_columns_ = header.by_columns;
  shape_ = std::move(header.shape);
  begin_ = header.begin;
}

std::string NpyArray::shape_text() const {
  return shape_.empty() ? "a single number" : fmt::format("{}", fmt::join(shape_, " x "));
}

void NpyArray::require_numbers() const {
  if (!format_) {
    fail(
        fmt::format("numbers of the type {} (allowed: integers and floating-point numbers of "
                    "32 and 64 bits, such as <f8)",
                    quoted_piece(type_)));
  }
  // No dimension and no product can overflow, because each is compared with the file's size.
  std::size_t bytes = format_->bytes;
  for (const std::size_t size : shape_) {
    if (size > InputFile::largest_file) fail(too_large(*this));
    bytes *= size;
    if (bytes > InputFile::largest_file) fail(too_large(*this));
  }
  const std::size_t there = bytes_.size() - begin_;
  if (there == bytes) return;
  fail(fmt::format("{} numbers of {} bytes are {} bytes, and {} are there: {}", shape_text(),
                   format_->bytes, bytes, there,
                   there < bytes ? "the file is cut off" : "more than one array"));
}

double NpyArray::at(std::initializer_list<std::size_t> index) const {
  std::size_t number = 0;
  if (by_columns_) {
    for (std::size_t k = index.size(); k-- > 0;) number = number * shape_[k] + index.begin()[k];
  } else {
    for (std::size_t k = 0; k < index.size(); ++k) number = number * shape_[k] + index.begin()[k];
  }
  return numbers_from(bytes_.substr(begin_ + number * format_->bytes), 1, *format_).front();
}

void NpyArray::fail(const std::string& problem) const {
  throw InputError(fmt::format("{}: {}", where_, problem));
}

}  // namespace dlo::compare
