#pragma once

#include <string>
#include <vector>

#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "recording/motion_check.hpp"

namespace dlo::compare {

/// Returns a number with 4 significant digits; a dash for NaN.
[[nodiscard]] std::string page_number(double value);

/// A picture of a page.
struct PagePicture {
  std::string svg;      ///< an element of the page (inline_svg()); empty: it could not be drawn
  std::string failure;  ///< why it could not be drawn
};

/// A number that is shown large.
struct PageNumber {
  std::string name, value, note;
};

/// A table of texts. The first cell of each row is its head.
struct PageTable {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

/// One result of a page. All texts are plain; the page escapes them.
struct PageResult {
  std::string title;
  bool passes = false;
  std::string verdict;  ///< words of the badge, such as "pass"
  std::string summary;  ///< what was compared and how far it is away
  std::string cause;    ///< the best cause, in bold; empty: none is known
  std::vector<PageNumber> numbers;
  std::vector<PagePicture> pictures;
  PageTable table;           ///< below; empty: none
  std::string details = {};  ///< folded: all that the command prints
};

/// Returns results as one HTML file that loads nothing and has no script: of each its verdict,
/// cause, numbers and pictures on one screen, and the rest folded below.
/// @param command  that writes it, such as "dlo check";  @param version  of dlo
[[nodiscard]] std::string page_html(const std::vector<PageResult>& results,
                                    const std::string& command, const std::string& version);

/// Returns a judged shape for a page, without pictures and details.
[[nodiscard]] PageResult page_result(const CheckResult& result);

/// Returns a judged motion for a page, without pictures and details.
[[nodiscard]] PageResult page_result(const MotionCheck& check);

/// Returns a comparison for a page, without pictures and details. It passes if the RMS is within
/// default_tolerance(); its cause is the largest part of the error budget.
[[nodiscard]] PageResult page_result(const Comparison& comparison);

}  // namespace dlo::compare
