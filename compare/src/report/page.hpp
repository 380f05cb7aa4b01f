#pragma once

#include <string>
#include <vector>

#include "figure/layout.hpp"
#include "report/folder.hpp"
#include "report/report.hpp"

namespace dlo::compare {

/// A figure as far as it is drawn.
struct PageFigure {
  Figure figure;
  std::string svg;      ///< element of a page, see inline_svg
  std::string failure;  ///< why there is none
};

/// The whole page, in one file: style and figures in it, nothing to be fetched. Its script adds a
/// section that can be turned and slid; all else is there without it.
/// @param drawn_by  see gnuplot_version
[[nodiscard]] std::string report_page(const Report& report, const std::vector<PageFigure>& figures,
                                      const ReportMaker& maker, const std::string& drawn_by);

}  // namespace dlo::compare
