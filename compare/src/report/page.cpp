#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/builtin_data.hpp"
#include "base/quote.hpp"

namespace dlo::compare {
namespace {

/// Returns escape_markup() of each line, with line breaks unchanged.
std::string escape_lines(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += escape_markup(text.substr(at, end - at)) + "\n";
    at = end + 1;
  }
  return out;
}

std::string to_html(const std::vector<PageNumber>& numbers) {
  std::string out = "<dl>\n";
  for (const PageNumber& number : numbers) {
    out += fmt::format("<div><dt>{}</dt><dd><strong>{}</strong> <span>{}</span></dd></div>\n",
                       escape_markup(number.name), escape_markup(number.value),
                       escape_markup(number.note));
  }
  return out + "</dl>\n";
}

std::string to_html(const std::vector<PagePicture>& pictures) {
  std::string out = "<div class=\"figures\">\n";
  for (const PagePicture& picture : pictures) {
    out += picture.svg.empty() ? fmt::format("<p class=\"missing\">A figure is missing: {}.</p>\n",
                                             escape_markup(picture.failure))
                               : "<figure>\n" + picture.svg + "</figure>\n";
  }
  return out + "</div>\n";
}

std::string to_html(const PageTable& table) {
  std::string out = fmt::format("<div class=\"table\">\n<table>\n<caption>{}</caption>\n<tr>",
                                escape_markup(table.caption));
  for (const std::string& head : table.head) {
    out += fmt::format("<th scope=\"col\">{}</th>", escape_markup(head));
  }
  out += "</tr>\n";
  for (const std::vector<std::string>& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string cell = escape_markup(row[i]);
      out += i == 0 ? "<th scope=\"row\">" + cell + "</th>" : "<td>" + cell + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</table>\n</div>\n";
}

std::string to_html(const PageResult& result) {
  std::string out = fmt::format(
      "<h1>{}</h1>\n<div class=\"screen\">\n<div>\n<p class=\"badge {}\">{} {}</p>\n<p>{}</p>\n",
      escape_markup(result.title), result.passes ? "pass" : "fail",
      result.passes ? "\u2713" : "\u2717", escape_markup(result.verdict),
      escape_markup(result.summary));
  if (!result.cause.empty()) {
    out += "<p><strong>" + escape_markup(result.cause) + "</strong></p>\n";
  }
  out += to_html(result.numbers) + "</div>\n" + to_html(result.pictures) + "</div>\n";
  if (!result.table.rows.empty()) out += to_html(result.table);
  if (!result.details.empty()) {
    out += "<details><summary>All that the command prints</summary>\n<pre tabindex=\"0\">" +
           escape_lines(result.details) + "</pre>\n</details>\n";
  }
  return out;
}

}  // namespace

std::string page_number(double value) {
  if (std::isnan(value)) return "\u2013";
  return fmt::format("{:.4g}", value + 0.0);
}

std::string page_html(const std::vector<PageResult>& results, const std::string& command,
                      const std::string& version) {
  std::string title = command;
  for (const PageResult& result : results) {
    title += fmt::format(", {}: {}", result.title, result.verdict);
  }
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"{}\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n",
      command, escape_markup(title), builtin::page_css);
  for (const PageResult& result : results) out += to_html(result);
  return out + fmt::format("<p class=\"faint\">dlo {}</p>\n</main>\n</body>\n</html>\n",
                           escape_markup(version));
}

}  // namespace dlo::compare
