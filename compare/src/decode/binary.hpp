#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dlo::compare {

/// A kind of number in a binary file.
struct NumberFormat {
  enum class Kind { floating, integer, natural };
  Kind kind = Kind::floating;
  std::size_t bytes = sizeof(double);  ///< 4 or 8 of a floating one, else 1, 2, 4 or 8
  bool big_endian = false;
};

/// Whether there is such a kind.
[[nodiscard]] bool is_known(const NumberFormat& format);

/// `count` numbers from the beginning of some bytes, of which there are enough.
[[nodiscard]] std::vector<double> numbers_from(std::string_view bytes, std::size_t count,
                                               const NumberFormat& format);

/// A number without a sign that begins at `at`; none where the bytes end before.
/// @param size  1 to 8 of them
[[nodiscard]] std::optional<std::uint64_t> natural_at(std::string_view bytes, std::size_t at,
                                                      std::size_t size, bool big_endian = false);

}  // namespace dlo::compare
