#pragma once

#include <string>
#include <vector>

#include "report/report.hpp"

namespace dlo::compare {

/// Who makes a report, for its page.
struct ReportMaker {
  std::string version;  ///< of dlo
  std::string command;  ///< that was given
};

/// What was written.
struct WrittenReport {
  std::string page;         ///< path of index.html
  int figures = 0;          ///< drawn
  int figures_missing = 0;  ///< that the page has no picture of
  std::string why_missing;  ///< of the first of them
};

/// Whether a report may be written to a folder: if there is nothing of that name, or an empty
/// folder, or a report with nothing else in it, which is then replaced; not to the working
/// directory or one that holds it, nor where a file system is mounted. To be called before a report
/// is computed: it makes a folder beside that one and removes it, as proof that it can be done.
/// @throws InputError naming the folder, what is in the way and what is allowed
void check_report_folder(const std::string& folder);

/// A report replaces what is in its folder: none of what it reads may be there.
/// @param scenes  files or folders that it is about; what their scenes name is read too
/// @throws InputError naming both
void refuse_scenes_inside(const std::string& folder, const std::vector<std::string>& scenes);

/// Writes a report: index.html, which needs no other file; the scenes as scenes/NAME; for each
/// figure NAME.gp, which gnuplot draws, NAME.svg, and a CSV file with its numbers; files.txt, the
/// list of all of them, by which a later report knows that it may replace this one. Without gnuplot
/// there are no pictures, and the page says so.
///
/// All is made in a folder beside it and then renamed, so that no half report is ever seen.
/// @throws InputError as check_report_folder, or if it cannot be written
[[nodiscard]] WrittenReport write_report(const Report& report, const ReportMaker& maker,
                                         const std::string& folder);

}  // namespace dlo::compare
