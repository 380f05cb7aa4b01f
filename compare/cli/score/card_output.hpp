#pragma once

#include <string>
#include <vector>

#include "figure/layout.hpp"
#include "report/page.hpp"
#include "suite/card.hpp"

namespace dlo::cli {

/// Returns a table of classes for each simulator, followed by the causes of wrong scenes.
[[nodiscard]] std::string cards_text(const std::vector<compare::Card>& cards);

/// Returns the tables in Markdown, for a pull request.
[[nodiscard]] std::string cards_markdown(const std::vector<compare::Card>& cards);

/// Returns JUnit XML with one test case per scene: skipped if it is not supported, an error if
/// there is no result to judge, else a failure unless it is right.
[[nodiscard]] std::string cards_junit(const std::vector<compare::Card>& cards);

/// Draws the largest error of each class against N.
[[nodiscard]] compare::Figure card_figure(const compare::Card& card);

/// Returns results of a simulator for a page, without pictures: causes of wrong scenes, numbers by
/// class, and the wrong scenes as details.
[[nodiscard]] compare::PageResult card_page(const compare::Card& card);

}  // namespace dlo::cli
