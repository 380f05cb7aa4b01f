#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace dlo::compare {

/// What is around deflated data.
enum class Deflated {
  zlib,  ///< header and check sum of RFC 1950
  raw,   ///< nothing, as in a zip archive (RFC 1951)
};

/// Deflated bytes, inflated: no more than `size` of them, whatever the data say. None if they are
/// damaged, cut off, or of another size. @param part  whether they may go on after `size`
[[nodiscard]] std::optional<std::string> inflated(std::string_view bytes, std::size_t size,
                                                  Deflated form, bool part = false);

/// Check sum of a zip archive's entry.
[[nodiscard]] unsigned long crc_of(std::string_view bytes);

}  // namespace dlo::compare
