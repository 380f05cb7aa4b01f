#pragma once

#include <concepts>
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

/// What a cell of a table shows: a text, a whole number, or as page_number() any other.
[[nodiscard]] inline std::string cell_text(std::string text) { return text; }
template <std::integral Number>
[[nodiscard]] std::string cell_text(Number value) {
  return std::to_string(value);
}
[[nodiscard]] inline std::string cell_text(double value) { return page_number(value); }

/// A table of plain texts.
struct HtmlTable {
  std::string caption;
  std::vector<HtmlColumn> columns;
  std::vector<std::vector<std::string>> rows;

  template <typename... Cells>
  void add_row(const Cells&... cells) {
    rows.push_back({cell_text(cells)...});
  }
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

/// A page that needs nothing else, up to its body. @param generator  the command that writes it
[[nodiscard]] std::string html_begin(const std::string& generator, const std::string& title);

/// From the version to the end of a page whose body holds a <main>.
[[nodiscard]] std::string html_end(const std::string& version);

}  // namespace dlo::compare
