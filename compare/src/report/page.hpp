#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// Picture on a page.
struct PagePicture {
  std::string svg;      ///< element of the page (inline_svg()); empty if it could not be drawn
  std::string failure;  ///< reason why it could not be drawn
};

/// Result of a page. The page escapes its texts.
struct PageResult {
  std::string title;
  bool passes = false;
  std::string text;  ///< output of the command; its first line is the verdict
  std::vector<PagePicture> pictures = {};
};

/// Returns results as one HTML file that loads no other file and has no script. Each result has its
/// verdict as a badge, its pictures, and the rest of its text.
/// @param command  command that writes the page, such as "dlo check";  @param version  version of
/// dlo
[[nodiscard]] std::string page_html(const std::vector<PageResult>& results,
                                    const std::string& command, const std::string& version);

}  // namespace dlo::compare
