#pragma once

#include <string>

namespace dlo::compare {

/// A text as HTML and XML show it, in elements and in attributes; control characters, most of which
/// XML 1.0 has no way to write, become blanks, and what is no UTF-8 becomes U+FFFD.
[[nodiscard]] std::string escape_markup(const std::string& text);

}  // namespace dlo::compare
