#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// Type of a number in a binary file.
struct NumberFormat {
  enum class Kind { floating, integer, natural };
  Kind kind = Kind::floating;
  std::size_t bytes = sizeof(double);  ///< 4 or 8 of a floating-point number, else 1, 2, 4 or 8
  bool big_endian = false;
};

/// Whether the type is supported.
[[nodiscard]] bool is_known(const NumberFormat& format);

/// Returns `count` numbers from the beginning of some bytes, which must be long enough.
[[nodiscard]] std::vector<double> numbers_from(std::string_view bytes, std::size_t count,
                                               const NumberFormat& format);

/// Returns the unsigned number that begins at `at`; empty if the bytes end before it does.
/// @param size  number of bytes, 1 to 8
[[nodiscard]] std::optional<std::uint64_t> unsigned_at(std::string_view bytes, std::size_t at,
                                                       std::size_t size, bool big_endian = false);

}  // namespace dlo::compare
