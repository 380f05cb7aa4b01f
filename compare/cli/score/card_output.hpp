#pragma once

#include <string>
#include <vector>

#include "figure/layout.hpp"
#include "report/page.hpp"
#include "suite/card.hpp"

namespace dlo::cli {

/// A table of classes for each simulator, then what is wrong in which scene.
[[nodiscard]] std::string cards_text(const std::vector<compare::Card>& cards);

/// The same for a pull request.
[[nodiscard]] std::string cards_markdown(const std::vector<compare::Card>& cards);

/// A test case for each scene: a failure unless it is right, skipped if it is not supported.
[[nodiscard]] std::string cards_junit(const std::vector<compare::Card>& cards);

/// Draws the largest error of each class against N.
[[nodiscard]] compare::Figure card_figure(const compare::Card& card);

/// Returns a card for a page, without pictures: the causes of its wrong scenes, its numbers by
/// class, and the wrong scenes as details.
[[nodiscard]] compare::PageResult card_page(const compare::Card& card);

}  // namespace dlo::cli
