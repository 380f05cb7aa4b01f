#include "decode/npy_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <regex>
#include <utility>

#include "base/input_file.hpp"
#include "base/number.hpp"
#include "base/quote.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Largest size of a header [bytes]; those of numpy are below 200 bytes, except for structured
/// arrays, which are not read. std::regex needs stack for each byte.
constexpr std::size_t longest_header = 1000;

/// Header of an array.
struct Header {
  std::string type;  ///< as numpy writes it, such as <f8
  bool by_columns = false;
  std::vector<std::size_t> shape;
  std::size_t begin = 0;  ///< start of the numbers
};

/// Returns the value of a key of a header, a Python dictionary: the first group of the pattern.
std::string value_in(const std::string& header, const char* key, const char* pattern,
                     const std::string& name) {
  std::smatch found;
  const std::regex entry(fmt::format("'{}' *: *{}", key, pattern));
  if (std::regex_search(header, found, entry)) return found[1];
  throw InputError(fmt::format(
      "{}: a header without a {} of plain numbers (allowed: as NumPy saves an array)", name, key));
}

Header read_header(std::string_view bytes, const std::string& name) {
  constexpr std::size_t before_length = 8;
  const std::uint64_t version = unsigned_at(bytes, npy_magic.size(), 1).value_or(0);
  const std::size_t width = version == 1 ? 2 : 4;
  const std::optional<std::uint64_t> length = unsigned_at(bytes, before_length, width);
  if (!bytes.starts_with(npy_magic) || version < 1 || version > 3 || !length) {
    throw InputError(name + ": not an array as NumPy saves it, of format 1, 2 or 3");
  }
  const std::size_t begin = before_length + width;
  if (*length > longest_header || begin + *length > bytes.size()) {
    throw InputError(fmt::format("{}: a header of {} bytes (allowed: up to {}, in the file)", name,
                                 *length, longest_header));
  }
  const std::string text(bytes.substr(begin, *length));
  Header header{.type = value_in(text, "descr", "'([^']*)'", name),
                .by_columns = value_in(text, "fortran_order", "(True|False)", name) == "True",
                .shape = {},
                .begin = begin + *length};
  const std::string shape = value_in(text, "shape", "\\(([0-9, ]*)\\)", name);
  for (std::string_view rest = shape; !rest.empty();) {
    const auto [size, digits, error] = leading_number<std::size_t>(rest);
    if (error == std::errc::result_out_of_range) {
      throw InputError(fmt::format("{}: a shape with {} in it", name, quoted_piece(rest)));
    }
    if (digits > 0) header.shape.push_back(size);
    rest.remove_prefix(std::max<std::size_t>(digits, 1));
  }
  return header;
}

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
  Header header = read_header(bytes, where_);
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
  const std::size_t available = bytes_.size() - begin_;
  if (available == bytes) return;
  fail(fmt::format("{} numbers of {} bytes are {} bytes, and {} are there: {}", shape_text(),
                   format_->bytes, bytes, available,
                   available < bytes ? "the file is cut off" : "more than one array"));
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
