#include "decode/base64.hpp"

#include <cstdint>

namespace dlo::compare {
namespace {

/// Of a character of the alphabet; none of another.
std::optional<std::uint32_t> six_bits(char c) {
  constexpr std::uint32_t small = 26;
  constexpr std::uint32_t digits = 52;
  if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
  if (c >= 'a' && c <= 'z') return small + static_cast<std::uint32_t>(c - 'a');
  if (c >= '0' && c <= '9') return digits + static_cast<std::uint32_t>(c - '0');
  if (c == '+') return 62;
  if (c == '/') return 63;
  return std::nullopt;
}

}  // namespace

std::optional<std::string> from_base64(std::string_view code, std::size_t most) {
  std::string bytes;
  std::uint32_t bits = 0;
  int characters = 0;
  int padding = 0;
  for (const char c : code) {
    if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (bytes.size() >= most) break;
    const std::optional<std::uint32_t> value = six_bits(c);
    const bool pads = c == '=' && characters >= 2;
    if (!pads && (!value || padding > 0)) return std::nullopt;
    if (pads) ++padding;
    bits = bits << 6 | value.value_or(0);
    if (++characters < 4) continue;
    for (int i = 0; i < 3 - padding; ++i) bytes += static_cast<char>(bits >> (16 - 8 * i) & 0xFF);
    bits = 0;
    characters = padding = 0;
  }
  if (characters > 0) return std::nullopt;
  if (bytes.size() > most) bytes.resize(most);
  return bytes;
}

}  // namespace dlo::compare
