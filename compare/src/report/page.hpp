#pragma once

#include <string>
#include <vector>

#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "recording/motion_check.hpp"

namespace dlo::compare {

/// Returns a number with 4 significant digits; a dash for NaN.
[[nodiscard]] std::string page_number(double value);

/// Picture on a page.
struct PagePicture {
  std::string svg;      ///< element of the page (inline_svg()); empty if it could not be drawn
  std::string failure;  ///< reason why it could not be drawn
};

/// Number that is shown in large type.
struct PageNumber {
  std::string name, value, note;
};

/// Table of texts. The first cell of each row is its header.
struct PageTable {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// One result of a page. All texts are plain; the page escapes them.
struct PageResult {
  std::string title;
  bool passes = false;
  std::string verdict;  ///< text of the badge, such as "pass"
  std::string summary;  ///< compared quantities and their distance
  std::string cause;    ///< the best cause, in bold; empty if none is known
  std::vector<PageNumber> numbers;
  std::vector<PagePicture> pictures;
  PageTable table;           ///< below the pictures; empty: no table
  std::string details = {};  ///< folded text: the full output of the command
};

/// Returns results as one HTML file that loads no other file and has no script. Verdict, cause,
/// numbers and pictures of each result fit on one screen; the rest is folded below.
/// @param command  command that writes the page, such as "dlo check";  @param version  version of
/// dlo
[[nodiscard]] std::string page_html(const std::vector<PageResult>& results,
                                    const std::string& command, const std::string& version);

/// Returns the result of a shape check for a page, without pictures and details.
[[nodiscard]] PageResult page_result(const CheckResult& result);

/// Returns the result of a motion check for a page, without pictures and details.
[[nodiscard]] PageResult page_result(const MotionCheck& check);

/// Returns a comparison for a page, without pictures and details. It passes if the RMS is within
/// default_tolerance(); its cause is the largest part of the error budget.
[[nodiscard]] PageResult page_result(const Comparison& comparison);

}  // namespace dlo::compare
