#include "report/check_page.hpp"

#include <fmt/format.h>

#include <sstream>

#include "base/quote.hpp"
#include "report/html.hpp"
#include "report/style.hpp"

namespace dlo::compare {
namespace {

std::string millimetres(double metres) { return page_number(metres * 1e3) + "\u00a0mm"; }

/// What would explain a shape that fails; empty if nothing does.
std::string cause_of(const CheckResult& result) {
  if (result.passes() || result.explanations.empty()) return {};
  const Explanation& best = result.explanations.front();
  return fmt::format("It would be {} away if {}{}.", millimetres(best.rms_m),
                     best.kind == ExplanationKind::discretisation ? "it were " : "", best.cause);
}

std::string three_numbers(const CheckResult& result) {
  const ShapeCheck& check = result.check;
  const Deviation& d = check.deviation;
  const EffectiveModulus& modulus = check.effective_modulus;
  const bool told = is_identified(modulus.optimum) && !result.supersedes_modulus;
  const std::string why_not = result.supersedes_modulus  ? "no measure of the material"
                              : modulus.why_none.empty() ? "not identified"
                                                         : modulus.why_none;
  return to_html(std::vector<HtmlNumber>{
      {"RMS distance", millimetres(d.rms_m), page_percent(d.rms_over_length) + " of the length"},
      {"largest", millimetres(d.max_m), fmt::format("at s = {:.4g} m", d.max_at_m)},
      {"E*/E", told ? page_number(modulus.ratio) : "\u2013",
       told ? millimetres(modulus.rms_m) + " away with it" : why_not}});
}

/// escape_markup() of lines, which stay lines.
std::string escape_lines(const std::string& text) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out += escape_markup(line) + "\n";
  return out;
}

HtmlTable causes(const CheckResult& result) {
  HtmlTable table{"What would explain it", {{"cause", HtmlCell::text}, {"RMS then"}}, {}};
  for (const Explanation& explanation : result.explanations) {
    table.rows.push_back({explanation.cause, millimetres(explanation.rms_m)});
  }
  return table;
}

std::string figures_of(const CheckPageParts& parts) {
  std::string out = "<div class=\"figures\">\n";
  for (const PageFigure& entry : parts.figures) {
    if (!entry.svg.empty()) {
      out += "<figure>\n" + entry.svg + "</figure>\n";
    } else {
      out += fmt::format("<p class=\"missing\">A figure is missing: {}.</p>\n",
                         escape_markup(entry.failure));
    }
  }
  return out + "</div>\n";
}

}  // namespace

std::string check_page(const CheckResult& result, const CheckPageParts& parts) {
  const ShapeTolerance& tolerance = result.tolerance;
  const char* const word = result.passes() ? "pass" : "fail";
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"dlo check\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{0}: {1}</title>\n<style>{2}</style>\n</head>\n<body>\n<main>\n"
      "<h1>{0}</h1>\n<div class=\"screen\">\n<div>\n",
      escape_markup(result.check.scene), word, report_style);
  out += html_badge(result.passes(), word);
  out +=
      fmt::format("<p>{} is {} away from the rod ({}). Allowed: {}{}.</p>\n",
                  escape_markup(result.check.file), millimetres(result.judgement.judged_m),
                  tolerance.largest ? "largest distance" : "RMS", millimetres(tolerance.allowed_m),
                  tolerance.by_default ? ", 1\u00a0% of the length, by default" : "");
  const std::string cause = cause_of(result);
  if (!cause.empty()) out += "<p><strong>" + escape_markup(cause) + "</strong></p>\n";
  const std::string both = other_stiffness_within(result);
  if (!both.empty()) out += "<p>" + escape_markup(both) + ".</p>\n";
  out += three_numbers(result) + "</div>\n" + figures_of(parts) + "</div>\n";
  out += "<details><summary>Reason and causes</summary>\n<p>" +
         escape_markup(result.judgement.reason) + ".</p>\n";
  if (!result.explanations.empty()) out += to_html(causes(result));
  out += "</details>\n<details><summary>All that dlo check says</summary>\n<pre tabindex=\"0\">" +
         escape_lines(parts.text) + "</pre>\n</details>\n";
  return out + fmt::format("<p class=\"faint\">dlo {}</p>\n</main>\n</body>\n</html>\n",
                           escape_markup(parts.version));
}

}  // namespace dlo::compare
