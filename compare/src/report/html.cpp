#include "report/html.hpp"

#include <fmt/format.h>

#include <cmath>

#include "report/style.hpp"

namespace dlo::compare {

std::string page_number(double value) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  return fmt::format("{:.4g}", value + 0.0);
}

std::string page_percent(double share) {
  return std::isfinite(share) ? page_number(share * 100) + "\u00a0%" : page_number(share);
}

std::string to_html(const HtmlTable& table) {
  const std::string caption = escape_markup(table.caption);
  std::string out = fmt::format(
      "<div class=\"table\" role=\"region\" aria-label=\"{0}\" tabindex=\"0\">\n"
      "<table>\n<caption><span>{0}</span></caption>\n<thead><tr>",
      caption);
  const auto class_of = [&](std::size_t column) {
    switch (table.columns.at(column).cell) {
      case HtmlCell::number:
        return " class=\"n\"";
      case HtmlCell::word:
        return " class=\"w\"";
      case HtmlCell::text:
        break;
    }
    return "";
  };
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    out += fmt::format("<th scope=\"col\"{}>{}</th>", class_of(i),
                       escape_markup(table.columns[i].head));
  }
  out += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      out += i == 0 ? fmt::format("<th scope=\"row\"{}>{}</th>", class_of(i), escape_markup(row[i]))
                    : fmt::format("<td{}>{}</td>", class_of(i), escape_markup(row[i]));
    }
    out += "</tr>\n";
  }
  return out + "</tbody>\n</table>\n</div>\n";
}

std::string to_html(const std::vector<HtmlNumber>& numbers) {
  std::string out = "<dl class=\"three\">\n";
  for (const HtmlNumber& number : numbers) {
    out += fmt::format("<div><dt>{}</dt><dd><strong>{}</strong> <span>{}</span></dd></div>\n",
                       escape_markup(number.name), escape_markup(number.value),
                       escape_markup(number.beside));
  }
  return out + "</dl>\n";
}

std::string html_badge(bool pass, const std::string& words) {
  return fmt::format("<p class=\"badge {}\">{} {}</p>\n", pass ? "pass" : "fail",
                     pass ? "\u2713" : "\u2717", escape_markup(words));
}

std::string html_begin(const std::string& generator, const std::string& title) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"{}\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n",
      generator, escape_markup(title), report_style);
}

std::string html_end(const std::string& version) {
  return fmt::format("<p class=\"faint\">dlo {}</p>\n</main>\n</body>\n</html>\n",
                     escape_markup(version));
}

}  // namespace dlo::compare
