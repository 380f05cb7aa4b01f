#include "report/check_page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "base/number.hpp"
#include "base/quote.hpp"
#include "report/html.hpp"

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

HtmlTable cause_table() {
  return {"What would explain it", {{"cause", HtmlCell::text}, {"RMS then"}}, {}};
}

HtmlTable causes(const CheckResult& result) {
  HtmlTable table = cause_table();
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

/// The page's head, and what its screen begins with.
std::string page_begin(const std::string& title, const std::string& file, bool passes,
                       double judged_m, const ShapeTolerance& tolerance) {
  const char* const word = passes ? "pass" : "fail";
  std::string out = html_begin("dlo check", title + ": " + word);
  out += fmt::format("<main>\n<h1>{}</h1>\n<div class=\"screen\">\n<div>\n", escape_markup(title));
  out += html_badge(passes, word);
  return out + fmt::format("<p>{} is {} away from the rod ({}). Allowed: {}{}.</p>\n",
                           escape_markup(file), millimetres(judged_m),
                           tolerance.largest ? "largest distance" : "RMS",
                           millimetres(tolerance.allowed_m),
                           tolerance.by_default ? ", 1\u00a0% of the length, by default" : "");
}

/// What is folded below the screen, and the page's end.
std::string page_end(const std::string& reason, const HtmlTable& causes,
                     const CheckPageParts& parts) {
  std::string out = figures_of(parts) + "</div>\n";
  out += "<details><summary>Reason and causes</summary>\n<p>" + escape_markup(reason) + ".</p>\n";
  if (!causes.rows.empty()) out += to_html(causes);
  out += "</details>\n<details><summary>All that dlo check says</summary>\n<pre tabindex=\"0\">" +
         escape_lines(parts.text) + "</pre>\n</details>\n";
  return out + html_end(parts.version);
}

std::string three_numbers(const MotionCheck& check) {
  const FrameError& worst = check.worst();
  const double length = check.scene.length;
  const bool lags = std::isfinite(check.lag);
  return to_html(std::vector<HtmlNumber>{
      {"RMS distance", millimetres(shown(check.errors.rms_m, length)),
       page_percent(shown(check.errors.rms_m, length) / length) + " of the length"},
      {"worst frame", millimetres(shown(worst.rms_m, length)),
       fmt::format("at {:.4g} s", worst.time)},
      {"lag", lags ? page_number(check.lag * 1e3) + "\u00a0ms" : "\u2013",
       lags ? millimetres(shown(check.lag_rms_m, length)) + " away without it"
            : "none that explains much"}});
}

}  // namespace

std::string check_page(const CheckResult& result, const CheckPageParts& parts) {
  std::string out = page_begin(result.check.scene, result.check.file, result.passes(),
                               result.judgement.judged_m, result.tolerance);
  const std::string cause = cause_of(result);
  if (!cause.empty()) out += "<p><strong>" + escape_markup(cause) + "</strong></p>\n";
  const std::string both = other_stiffness_within(result);
  if (!both.empty()) out += "<p>" + escape_markup(both) + ".</p>\n";
  out += three_numbers(result) + "</div>\n";
  return out + page_end(result.judgement.reason, causes(result), parts);
}

std::string motion_check_page(const MotionCheck& check, const CheckPageParts& parts) {
  std::string out = page_begin(check.scene.name, check.file, check.passes,
                               shown(check.judged_m, check.scene.length), check.tolerance);
  const auto left = [&](const MotionCause& cause) {
    return millimetres(shown(cause.rms_m, check.scene.length));
  };
  if (!check.passes && !check.causes.empty()) {
    const MotionCause& best = check.causes.front();
    out += fmt::format("<p><strong>It would be {} away if {}.</strong></p>\n", left(best),
                       escape_markup(best.words));
  }
  out += three_numbers(check) + "</div>\n";
  HtmlTable table = cause_table();
  for (const MotionCause& cause : check.causes) {
    table.rows.push_back({cause.words, left(cause)});
  }
  return out + page_end(check.reason, table, parts);
}

}  // namespace dlo::compare
