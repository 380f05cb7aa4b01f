#pragma once

#include <string>
#include <vector>

#include "dlo/compare/check.hpp"
#include "recording/motion_check.hpp"
#include "report/page.hpp"

namespace dlo::compare {

/// What a page has beside the result.
struct CheckPageParts {
  std::vector<PageFigure> figures = {};  ///< of check_picture(), or of motion_check_picture()
  std::string text = {};                 ///< all that `dlo check` says
  std::string version = {};              ///< of dlo
};

/// A judged shape as a page of one screen: verdict, cause, the three numbers and the picture;
/// below, folded, all that is known. One file, nothing to be fetched, no script.
[[nodiscard]] std::string check_page(const CheckResult& result, const CheckPageParts& parts);

/// A judged motion likewise.
[[nodiscard]] std::string motion_check_page(const MotionCheck& check, const CheckPageParts& parts);

}  // namespace dlo::compare
