#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace dlo::compare {

/// Returns a text of characters that XML 1.0 allows: U+0000 to U+001F, also tabs and line breaks,
/// and U+007F become blanks, and invalid UTF-8, U+FFFE and U+FFFF become U+FFFD.
[[nodiscard]] std::string xml_text(const std::string& text);

/// Returns xml_text() escaped for elements and attributes of HTML and XML.
[[nodiscard]] std::string escape_markup(const std::string& text);

/// Returns a field of a CSV line, quoted if necessary; as display(), but with tabs and line breaks
/// kept.
[[nodiscard]] std::string csv_field(const std::string& text);

/// Returns a number as in all CSV output, never -0; an empty text for NaN and infinity.
/// @param digits  significant ones, 1 to 17
[[nodiscard]] std::string csv_number(double value, int digits = 10);

/// Returns a text as a TOML basic string, in quotes; control characters (U+0000 to U+001F, U+007F
/// to U+009F) are escaped.
[[nodiscard]] std::string toml_string(const std::string& text);

/// Returns a word for a shell, quoted if necessary; as display().
[[nodiscard]] std::string shell_word(const std::string& word);

/// Returns the first 40 bytes of a part of a file for a message, followed by "..." if there are
/// more, with "?" for each byte that is not printable ASCII.
[[nodiscard]] std::string printable_piece(std::string_view piece);

/// Returns printable_piece() in quotes.
[[nodiscard]] std::string quoted_piece(std::string_view piece);

/// A number as append() and formatted() print it: without a minus sign if all its printed digits
/// are zero.
template <typename Number>
struct UnsignedZero {
  Number value;
};

template <typename Argument>
using Printed = std::conditional_t<std::is_floating_point_v<std::remove_cvref_t<Argument>>,
                                   UnsignedZero<std::remove_cvref_t<Argument>>, Argument>;

/// Appends formatted text, in which no floating-point argument is printed as -0. Numbers in a list
/// (fmt::join) are not covered.
template <typename... Arguments>
void append(std::string& text, fmt::format_string<Printed<Arguments>...> format,
            Arguments&&... arguments) {
  const auto print = [&](auto&&... printed) {
    fmt::vformat_to(std::back_inserter(text), fmt::string_view(format),
                    fmt::make_format_args(printed...));
  };
  print(Printed<Arguments>{std::forward<Arguments>(arguments)}...);
}

/// Returns formatted text, with numbers as append() prints them.
template <typename... Arguments>
[[nodiscard]] std::string formatted(fmt::format_string<Printed<Arguments>...> format,
                                    Arguments&&... arguments) {
  std::string text;
  append(text, format, std::forward<Arguments>(arguments)...);
  return text;
}

}  // namespace dlo::compare

template <typename Number>
struct fmt::formatter<dlo::compare::UnsignedZero<Number>> : fmt::formatter<Number> {
  auto format(const dlo::compare::UnsignedZero<Number>& number,
              fmt::format_context& context) const {
    fmt::memory_buffer digits;
    fmt::format_context own(fmt::appender(digits), context.args(), context.locale());
    fmt::formatter<Number>::format(number.value, own);
    const std::string_view text(digits.data(), digits.size());
    const auto nowhere = std::string_view::npos;
    const bool is_zero = text.substr(0, text.find('e')).find_first_of("123456789") == nowhere &&
                         text.find('0') != nowhere;
    return fmt::formatter<Number>::format(is_zero ? Number{0} : number.value, context);
  }
};
