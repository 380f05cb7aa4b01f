#include "batch/junit.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/quote.hpp"

namespace dlo::compare {
namespace {

std::string case_xml(const JunitCase& one) {
  std::string text = fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">",
                                 escape_markup(one.group), escape_markup(one.name), one.seconds);
  const std::string message = escape_markup(one.message);
  if (one.outcome.empty()) {
    if (!message.empty()) text += fmt::format("<system-out>{}</system-out>", message);
  } else {
    text += fmt::format("<{} ", one.outcome);
    if (!one.type.empty()) text += fmt::format("type=\"{}\" ", escape_markup(one.type));
    text += fmt::format("message=\"{}\"/>", message);
  }
  return text + "</testcase>\n";
}

std::string counts_of(const std::vector<JunitCase>& cases) {
  const auto count = [&](const char* outcome) {
    return std::count_if(cases.begin(), cases.end(),
                         [outcome](const JunitCase& one) { return one.outcome == outcome; });
  };
  return fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\"", cases.size(),
                     count("failure"), count("error"), count("skipped"));
}

}  // namespace

std::string junit_xml(const std::vector<JunitSuite>& suites) {
  std::string text;
  std::vector<JunitCase> all;
  for (const JunitSuite& suite : suites) {
    text += fmt::format("  <testsuite name=\"{}\" {}>\n", escape_markup(suite.name),
                        counts_of(suite.cases));
    for (const JunitCase& one : suite.cases) text += case_xml(one);
    text += "  </testsuite>\n";
    all.insert(all.end(), suite.cases.begin(), suite.cases.end());
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n{}</testsuites>\n",
      counts_of(all), text);
}

}  // namespace dlo::compare
