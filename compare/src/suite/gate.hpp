#pragma once

#include <string>
#include <vector>

#include "batch/regression.hpp"
#include "suite/card.hpp"

namespace dlo::compare {

/// What became of a class of a card.
struct GroupChange {
  std::string simulator;                                ///< whose card
  std::string group;                                    ///< the class
  RegressionVerdict verdict = RegressionVerdict::same;  ///< worse: the gate is closed
  std::string message;                                  ///< one line
};

/// Holds cards against those of an earlier time, class by class. A class is worse if its largest
/// error at any N has grown beyond the tolerance, if fewer of its scenes are solved, or if a cause
/// has been found in more of them. One that the earlier card does not have is new.
[[nodiscard]] std::vector<GroupChange> compare_cards(const std::vector<Card>& before,
                                                     const std::vector<Card>& now,
                                                     const RegressionTolerance& tolerance = {});

/// Whether no class is worse, and none has other scenes than the earlier card.
[[nodiscard]] bool passes(const std::vector<GroupChange>& changes);

}  // namespace dlo::compare
