#include "base/display.hpp"

#include <cstddef>

namespace dlo::compare {
namespace {

/// Bytes of the well-formed sequence that a text begins with, 0: none (RFC 3629, section 4: no
/// surrogates, nothing longer than needed, nothing above U+10FFFF).
std::size_t sequence_length(std::string_view text) {
  const auto byte = [text](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const auto tails = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      if ((byte(i) & 0xc0U) != 0x80U) return false;
    }
    return true;
  };
  const unsigned first = byte(0);
  const unsigned second = byte(1);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return tails(1, 2) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f)) return 0;
    return tails(1, 3) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    if ((first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) return 0;
    return tails(1, 4) ? 4 : 0;
  }
  return 0;
}

bool is_control(std::string_view sequence) {
  const auto byte = [sequence](std::size_t i) { return static_cast<unsigned char>(sequence[i]); };
  if (sequence.size() == 1) return byte(0) < 0x20 || byte(0) == 0x7f;
  return sequence.size() == 2 && byte(0) == 0xc2 && byte(1) < 0xa0;
}

/// Control characters as they are, or each as a "?".
enum class Controls { kept, shown };

std::string repaired(std::string_view text, Controls controls) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    if (length == 0) {
      result += "\xef\xbf\xbd";
      text.remove_prefix(1);
      continue;
    }
    const std::string_view sequence = text.substr(0, length);
    if (controls == Controls::shown && is_control(sequence)) {
      result += '?';
    } else {
      result += sequence;
    }
    text.remove_prefix(length);
  }
  return result;
}

}  // namespace

std::string valid_utf8(std::string_view text) { return repaired(text, Controls::kept); }

std::string display(std::string_view text) { return repaired(text, Controls::shown); }

}  // namespace dlo::compare
