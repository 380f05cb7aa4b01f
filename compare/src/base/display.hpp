#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dlo::compare {

/// A text as UTF-8: what belongs to no well-formed sequence (RFC 3629) becomes U+FFFD.
/// Names of files are bytes; JSON, TOML and XML are text.
[[nodiscard]] std::string valid_utf8(std::string_view text);

/// A text as a JSON string, in quotes, as valid_utf8().
[[nodiscard]] std::string json_string(std::string_view text);

/// A name as one line of text shows it: valid_utf8(), and each control character (U+0000 to U+001F,
/// U+007F to U+009F) is a "?", so that no name breaks a line or steers a terminal.
[[nodiscard]] std::string display(std::string_view text);

/// Bytes of the control character that stands at a place of a text of valid UTF-8; 0: none.
[[nodiscard]] std::size_t control_bytes(std::string_view text, std::size_t at);

}  // namespace dlo::compare
