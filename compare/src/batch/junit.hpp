#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// One test case of a JUnit file.
struct JunitCase {
  std::string group;    ///< classname
  std::string name;     ///< unique in its group
  std::string outcome;  ///< "failure", "error" or "skipped"; empty: it passes
  std::string type;     ///< of a failure or an error, one word or a few
  std::string message;  ///< one line; may be empty
  double seconds = 0;   ///< wall time [s]
};

/// Test cases under one name.
struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

/// Returns JUnit XML with the counts of each suite and of all.
[[nodiscard]] std::string junit_xml(const std::vector<JunitSuite>& suites);

}  // namespace dlo::compare
