#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/builtin_data.hpp"
#include "base/quote.hpp"

namespace dlo::compare {
namespace {

std::string verdict_of(const PageResult& result) {
  return result.text.substr(0, result.text.find('\n'));
}

/// Returns escape_markup() of each line, each followed by a line break, also the last one.
std::string escape_lines(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out += escape_markup(text.substr(at, end - at)) + "\n";
    at = end + 1;
  }
  return out;
}

std::string to_html(const PageResult& result) {
  const std::string verdict = verdict_of(result);
  std::string out =
      fmt::format("<h1>{}</h1>\n<p class=\"badge {}\">{} {}</p>\n<div class=\"figures\">\n",
                  escape_markup(result.title), result.passes ? "pass" : "fail",
                  result.passes ? "\u2713" : "\u2717", escape_markup(verdict));
  for (const PagePicture& picture : result.pictures) {
    out += picture.svg.empty() ? fmt::format("<p class=\"missing\">A figure is missing: {}.</p>\n",
                                             escape_markup(picture.failure))
                               : "<figure>\n" + picture.svg + "</figure>\n";
  }
  return out + "</div>\n<pre tabindex=\"0\">" +
         escape_lines(result.text.substr(std::min(verdict.size() + 1, result.text.size()))) +
         "</pre>\n";
}

}  // namespace

std::string page_html(const std::vector<PageResult>& results, const std::string& command,
                      const std::string& version) {
  std::string title = command;
  for (const PageResult& result : results) {
    title += fmt::format(", {}: {}", result.title, verdict_of(result));
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
