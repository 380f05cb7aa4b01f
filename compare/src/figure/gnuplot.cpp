#include "figure/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "base/quote.hpp"
#include "base/text.hpp"
#include "foreign/child_process.hpp"

namespace dlo::compare {
namespace {

/// Time limit of gnuplot, minutes above the time of the largest figure on a busy machine [s].
constexpr double drawing_limit = 300;

/// Runs gnuplot without the user's start-up files.
ChildOutcome run_gnuplot(const std::string& argument, const ChildFiles& files) {
  return run_child({"gnuplot", "--default-settings", argument}, files, drawing_limit);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string joined_lines(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return std::string(trimmed(text));
}

}  // namespace

std::string gnuplot_version(const std::filesystem::path& folder) {
  const std::string out = "gnuplot_version.out";
  const ChildOutcome outcome = run_gnuplot("--version", {.folder = folder, .output = out});
  std::string version = outcome.problem.empty() ? joined_lines(text_of(folder / out)) : "";
  std::error_code ignored;
  std::filesystem::remove(folder / out, ignored);
  return version;
}

std::string run_script(const std::string& script, const std::string& output,
                       const std::filesystem::path& folder) {
  const std::string messages = script + ".err";
  std::string problem = run_gnuplot(script, {.folder = folder, .error = messages}).problem;
  const std::string message = joined_lines(text_of(folder / messages));
  std::error_code ignored;
  std::filesystem::remove(folder / messages, ignored);
  const std::string drawn = text_of(folder / output);
  const bool whole =
      output.ends_with(".svg") ? drawn.find("</svg>") != std::string::npos : !drawn.empty();
  if (problem.empty() && whole) return {};
  std::filesystem::remove(folder / output, ignored);
  if (problem.empty()) problem = "no error message";
  return "gnuplot failed: " + (message.empty() ? problem : message);
}

std::string inline_svg(const std::string& svg, const std::string& name, const std::string& title) {
  const std::size_t element = svg.find("<svg");
  const std::size_t end = svg.rfind("</svg>");
  if (element == std::string::npos || end == std::string::npos) {
    throw std::invalid_argument(fmt::format("inline_svg: {}: no svg element", name));
  }
  std::string body = svg.substr(element + 4, end - element - 4);
  for (const char* tag : {"title", "desc"}) {
    const std::size_t from = body.find(fmt::format("<{}>", tag));
    const std::string close = fmt::format("</{}>", tag);
    const std::size_t to = body.find(close);
    if (from < to && to != std::string::npos) body.erase(from, to + close.size() - from);
  }
  body = replace_placeholders(body, {{" id='", " id='" + name + "-"},
                                     {" id=\"", " id=\"" + name + "-"},
                                     {"href='#", "href='#" + name + "-"},
                                     {"href=\"#", "href=\"#" + name + "-"}});
  body.replace(body.find('>'), 1,
               fmt::format(">\n<title id=\"{}-title\">{}</title>", name, escape_markup(title)));
  return fmt::format("<svg role=\"img\" aria-labelledby=\"{}-title\"{}</svg>\n", name, body);
}

}  // namespace dlo::compare
