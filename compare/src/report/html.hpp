#pragma once

#include <string>
#include <vector>

#include "base/quote.hpp"

namespace dlo::compare {

/// A number with 4 significant digits; a dash for NaN, which says that there is none.
[[nodiscard]] std::string page_number(double value);

/// A share in percent, the sign never in another line than the number.
[[nodiscard]] std::string page_percent(double share);

enum class HtmlCell {
  text,    ///< may break into lines
  word,    ///< stays in one line
  number,  ///< so does this, aligned to the right
};

struct HtmlColumn {
  std::string head;
  HtmlCell cell = HtmlCell::number;
};

/// A table of plain texts.
struct HtmlTable {
  std::string caption;
  std::vector<HtmlColumn> columns;
  std::vector<std::vector<std::string>> rows;
};

/// The first cell of a row is its head. A table too wide for the page scrolls by itself.
[[nodiscard]] std::string to_html(const HtmlTable& table);

/// A number that is shown large.
struct HtmlNumber {
  std::string name, value, beside;
};

[[nodiscard]] std::string to_html(const std::vector<HtmlNumber>& numbers);

/// A verdict in colour, with a mark and in words.
[[nodiscard]] std::string html_badge(bool pass, const std::string& words);

}  // namespace dlo::compare
