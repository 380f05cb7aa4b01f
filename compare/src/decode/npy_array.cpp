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

/// Returns the value of a key of a header, a Python dictionary: the first group of the pattern.
std::string value_in(const std::string& header, const char* key, const char* pattern,
                     const std::string& name) {
  std::smatch found;
  const std::regex entry(fmt::format("'{}' *: *{}", key, pattern));
  if (std::regex_search(header, found, entry)) return found[1];
  throw InputError(fmt::format(
      "{}: a header without a {} of plain numbers (allowed: as NumPy saves an array)", name, key));
}

/// Returns the number format of a type; empty if it is not supported.
std::optional<NumberFormat> format_of(std::string_view type) {
  constexpr std::string_view kinds = "fiu";  // in the order of NumberFormat::Kind
  if (type.size() != 3 || std::string_view("<>|=").find(type[0]) == std::string_view::npos) {
    return std::nullopt;
  }
  const std::size_t kind = kinds.find(type[1]);
  if (kind == std::string_view::npos) return std::nullopt;
  const NumberFormat format{.kind = static_cast<NumberFormat::Kind>(kind),
                            .bytes = static_cast<std::size_t>(type[2] - '0'),
                            .big_endian = type[0] == '>'};
  return is_known(format) ? std::optional(format) : std::nullopt;
}

std::string too_large(const NpyArray& array) {
  return fmt::format("{} numbers (allowed: files of up to {} bytes)", array.shape_text(),
                     InputFile::largest_file);
}

}  // namespace

NpyArray::NpyArray(std::string_view bytes, std::string where)
    : bytes_(bytes), where_(std::move(where)) {
  constexpr std::size_t before_length = 8;
  const std::uint64_t version = unsigned_at(bytes, npy_magic.size(), 1).value_or(0);
  const std::size_t width = version == 1 ? 2 : 4;
  const std::optional<std::uint64_t> length = unsigned_at(bytes, before_length, width);
  if (!bytes.starts_with(npy_magic) || version < 1 || version > 3 || !length) {
    fail("not an array as NumPy saves it, of format 1, 2 or 3");
  }
  begin_ = before_length + width + *length;
  if (*length > longest_header || begin_ > bytes.size()) {
    fail(fmt::format("a header of {} bytes (allowed: up to {}, in the file)", *length,
                     longest_header));
  }
  const std::string header(bytes.substr(before_length + width, *length));
  type_ = value_in(header, "descr", "'([^']*)'", where_);
  format_ = format_of(type_);
  by_columns_ = value_in(header, "fortran_order", "(True|False)", where_) == "True";
  const std::string shape = value_in(header, "shape", "\\(([0-9, ]*)\\)", where_);
  for (std::string_view rest = shape; !rest.empty();) {
    const auto [size, digits, error] = leading_number<std::size_t>(rest);
    if (error == std::errc::result_out_of_range) {
      fail(fmt::format("a shape with {} in it", quoted_piece(rest)));
    }
    if (digits > 0) shape_.push_back(size);
    rest.remove_prefix(std::max<std::size_t>(digits, 1));
  }
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
  // No dimension and no product can overflow, because each is at most InputFile::largest_file.
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
