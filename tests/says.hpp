#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "helpers.hpp"

namespace dlo::test {

/// Whether a text has each of these parts; the failure names the first that it lacks.
inline testing::AssertionResult has_all(const std::string& text,
                                        const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos) {
      return testing::AssertionFailure() << "no \"" << part << "\" in " << text;
    }
  }
  return testing::AssertionSuccess();
}

/// Whether a text has none of these parts; the failure names the first that it has.
inline testing::AssertionResult has_none(const std::string& text,
                                         const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    if (text.find(part) != std::string::npos) {
      return testing::AssertionFailure() << "\"" << part << "\" in " << text;
    }
  }
  return testing::AssertionSuccess();
}

/// Returns the text of the error of this type that work throws, or "no error". Errors of other
/// types reach the test.
template <typename Error, typename Work>
std::string error_of(const Work& work) {
  try {
    (void)work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace dlo::test
