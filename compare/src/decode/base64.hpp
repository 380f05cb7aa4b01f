#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace dlo::compare {

/// The bytes that base64 stands for (RFC 4648); blanks and line breaks are skipped. Several codes
/// may follow on, each padded by itself. None if another character is there, or a code is cut off.
/// @param most  bytes after which it stops
[[nodiscard]] std::optional<std::string> from_base64(std::string_view code, std::size_t most);

}  // namespace dlo::compare
