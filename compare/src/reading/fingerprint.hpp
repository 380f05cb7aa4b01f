#pragma once

#include <string>

namespace dlo::compare {

/// 16 hexadecimal digits that differ for different texts, but for accidents (XXH3, 64 bits).
[[nodiscard]] std::string fingerprint(const std::string& text);

}  // namespace dlo::compare
