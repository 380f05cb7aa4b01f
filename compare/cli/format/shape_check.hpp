#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/explanation.hpp"
#include "dlo/compare/friction_check.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_verdict.hpp"
#include "format/json.hpp"

namespace dlo::cli {

/// What was allowed, and whether the shape keeps to it.
struct Verdict {
  compare::ShapeTolerance tolerance;
  compare::ShapeJudgement judgement;

  [[nodiscard]] const char* text() const { return judgement.pass ? "pass" : "fail"; }
};

/// A compared shape with what was asked.
struct ShapeCheckReport {
  compare::Scene scene;
  compare::ShapeCheck check;
  std::optional<Verdict> verdict;  ///< without a tolerance none
  /// Of a shape that fails, the best first.
  std::vector<compare::Explanation> explanations = {};
  /// Where an obstacle in reach has friction.
  std::optional<compare::FrictionCheck> friction = std::nullopt;
  compare::PoseFreedom pose = compare::PoseFreedom::known;
  std::string unit_hint;  ///< where the check itself has none
  std::string file;       ///< of the text; empty: standard output, which may be a terminal
};

/// Whether it is looked for what is wrong with a shape that fails.
enum class Explaining { yes, no };

/// Judges a report's check by its verdict's tolerance and, where the shape fails, looks for what
/// could be wrong with it.
void judge(ShapeCheckReport& report, const compare::MeasuredShape& shape,
           const compare::ShapeCheckOptions& options, Explaining explaining);

[[nodiscard]] std::string shape_check_text(const ShapeCheckReport& report);

[[nodiscard]] Json shape_check_json(const ShapeCheckReport& report);

[[nodiscard]] std::string shape_check_csv(const ShapeCheckReport& report);

}  // namespace dlo::cli
