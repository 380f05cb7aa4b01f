#pragma once

#include <string>
#include <vector>

#include "suite/card.hpp"
#include "suite/gate.hpp"

namespace dlo::cli {

/// A table of classes for each simulator, then what is wrong in which scene.
[[nodiscard]] std::string cards_text(const std::vector<compare::Card>& cards);

/// The same for a pull request.
[[nodiscard]] std::string cards_markdown(const std::vector<compare::Card>& cards);

/// A test case for each scene: a failure unless it is right, skipped if it is not supported.
[[nodiscard]] std::string cards_junit(const std::vector<compare::Card>& cards);

/// A page of one screen for each simulator, with a badge; needs no other file.
[[nodiscard]] std::string cards_page(const std::vector<compare::Card>& cards,
                                     const std::string& version);

/// A line for each class that has changed.
[[nodiscard]] std::string changes_text(const std::vector<compare::GroupChange>& changes);

}  // namespace dlo::cli
