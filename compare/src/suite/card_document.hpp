#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "batch/regression_run.hpp"
#include "suite/card.hpp"

namespace dlo::compare {

/// Cards as a document with schema dlo/card/1; an error or order that is not known is NaN.
[[nodiscard]] nlohmann::ordered_json cards_json(const std::vector<Card>& cards);

/// Compares the errors of cards with a baseline of `dlo regress`: a case for each scene, simulator
/// and N, without the scenes that a simulator does not support. Cases of the baseline of other
/// scenes or simulators are not compared, and stay in Regression::cases.
[[nodiscard]] Regression judge_cards(const std::vector<BaselineCase>& baseline,
                                     const std::vector<Card>& cards,
                                     const RegressionTolerance& tolerance = {});

}  // namespace dlo::compare
