#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// One test case of a JUnit file.
struct JunitCase {
  std::string group;    ///< classname attribute
  std::string name;     ///< unique in its group
  std::string outcome;  ///< "failure", "error" or "skipped"; empty if the test case passes
  std::string type;     ///< type of the failure or error, one or a few words
  std::string message;  ///< one line; may be empty
  double seconds = 0;   ///< wall time [s]
};

/// Named group of test cases.
struct JunitSuite {
  std::string name;
  std::vector<JunitCase> cases;
};

/// Returns JUnit XML with the counts of each suite and the total counts.
[[nodiscard]] std::string junit_xml(const std::vector<JunitSuite>& suites);

}  // namespace dlo::compare
