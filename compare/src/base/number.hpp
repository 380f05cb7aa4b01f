#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dlo::compare {

/// Of a number that std::from_chars finds out of range: whether it is too small for a double, not
/// too large. @param number  digits with at most one point, and an exponent
[[nodiscard]] bool underflows(std::string_view number);

/// What is wrong with such a number, and what is allowed.
[[nodiscard]] std::string beyond_double(std::string_view number);

/// The whole of a field as a number, which may be infinite or NaN; nothing if it is none.
[[nodiscard]] std::optional<double> shape_number(std::string_view field);

}  // namespace dlo::compare
