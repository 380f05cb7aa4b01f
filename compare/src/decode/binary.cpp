#include "decode/binary.hpp"

#include <bit>

namespace dlo::compare {
namespace {

double number_of(std::uint64_t bits, const NumberFormat& format) {
  switch (format.kind) {
    case NumberFormat::Kind::floating:
      if (format.bytes == sizeof(double)) return std::bit_cast<double>(bits);
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case NumberFormat::Kind::integer: {
      // The sign bit of a shorter number is moved to that of 64 bits and back.
      const auto shift = static_cast<int>(64 - 8 * format.bytes);
      return static_cast<double>(static_cast<std::int64_t>(bits << shift) >> shift);
    }
    case NumberFormat::Kind::natural:
      break;
  }
  return static_cast<double>(bits);
}

}  // namespace

bool is_known(const NumberFormat& format) {
  const std::size_t n = format.bytes;
  if (format.kind == NumberFormat::Kind::floating) return n == sizeof(float) || n == sizeof(double);
  return n == 1 || n == 2 || n == 4 || n == 8;
}

std::optional<std::uint64_t> unsigned_at(std::string_view bytes, std::size_t at, std::size_t size,
                                         bool big_endian) {
  if (at > bytes.size() || bytes.size() - at < size) return std::nullopt;
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t from = big_endian ? i : size - 1 - i;
    value = value << 8 | static_cast<unsigned char>(bytes[at + from]);
  }
  return value;
}

std::vector<double> numbers_from(std::string_view bytes, std::size_t count,
                                 const NumberFormat& format) {
  std::vector<double> numbers;
  numbers.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    numbers.push_back(number_of(
        unsigned_at(bytes, i * format.bytes, format.bytes, format.big_endian).value(), format));
  }
  return numbers;
}

}  // namespace dlo::compare
