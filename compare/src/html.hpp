#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// A text as HTML shows it, in elements and in attributes; control characters become blanks.
[[nodiscard]] std::string escape_html(const std::string& text);

/// A number with 4 significant digits; a dash for NaN, which says that there is none.
[[nodiscard]] std::string page_number(double value);

/// A share in percent.
[[nodiscard]] std::string page_percent(double share);

struct HtmlColumn {
  std::string head;
  bool numbers = true;  ///< aligned to the right
};

/// A table of plain texts.
struct HtmlTable {
  std::string caption;
  std::vector<HtmlColumn> columns;
  std::vector<std::vector<std::string>> rows;
};

/// The first cell of a row is its head. A table too wide for the page scrolls by itself.
[[nodiscard]] std::string to_html(const HtmlTable& table);

}  // namespace dlo::compare
