#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/explanation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/shape_file.hpp"
#include "dlo/compare/shape_verdict.hpp"

namespace dlo::compare {

/// Whether causes of a failed comparison are searched.
enum class Explaining { yes, no };

/// Options of a check.
struct CheckRequest {
  std::optional<ShapeTolerance> tolerance;  ///< empty: default_tolerance()
  Explaining explaining = Explaining::yes;  ///< does not affect the verdict
  ShapeCheckOptions shape;                  ///< options of the comparison
};

/// Comparison of a shape with its scene's energy model, with the verdict: the result of `dlo
/// check`, and of the checks of Python and GoogleTest.
struct CheckResult {
  Scene scene;                            ///< scene that the shape was compared with
  ShapeCheck check;                       ///< deviation of the shape
  ShapeTolerance tolerance;               ///< tolerance that was applied
  ShapeJudgement judgement;               ///< verdict with its reason
  std::vector<Explanation> explanations;  ///< causes of a verdict `fail`, best first
  /// Cause that explains the shape better than any stiffness.
  std::optional<Explanation> superseding_cause;
  PoseFreedom pose = PoseFreedom::known;  ///< unknown part of the shape's frame
  std::vector<std::string> notes;         ///< how the shape file was interpreted
  /// TrivialShape::deflection_m. It is computed if the tolerance is a share of the deflection, or
  /// if the shape passes and weight or loads act. NaN if it was not computed, or no trivial shape
  /// was found.
  double deflection_m = std::numeric_limits<double>::quiet_NaN();

  /// Whether the verdict is `pass`.
  [[nodiscard]] bool passes() const { return judgement.passes(); }
};

/// Explains why a shape passes as the rod although E* is identified and differs from E by 5 % or
/// more. Empty if one of these conditions does not hold, or if the verdict is not significant.
[[nodiscard]] std::string other_stiffness_within(const CheckResult& result);

/// Compares, judges and, if the verdict is `fail`, searches for causes.
/// @throws InputError, ConvergenceError
[[nodiscard]] CheckResult check(const Scene& scene, const MeasuredShape& shape,
                                const CheckRequest& request = {});

/// Tolerance of a test: a share of the rod's length or of its deflection.
struct ToleranceShare {
  double share = 0;  ///< [-], > 0
  /// Whether `share` is of TrivialShape::deflection_m, not of the length.
  bool of_deflection = false;

  /// Takes a share of the length [-]. Implicit, so that tests may pass a number.
  ToleranceShare(double of_length) : share(of_length) {}  // NOLINT(google-explicit-constructor)
  /// Takes a share of the length or of the deflection [-].
  ToleranceShare(double value, bool is_of_deflection)
      : share(value), of_deflection(is_of_deflection) {}
};

/// Returns a share of the deflection, for stiff rods: EXPECT_SHAPE_NEAR(shape, scene,
/// of_deflection(0.05)).
[[nodiscard]] inline ToleranceShare of_deflection(double share) { return {share, true}; }

/// Outcome of a comparison in a test.
struct ShapeTestOutcome {
  bool near = false;  ///< whether check() passes
  /// Reason; then, on a separate line, the position of the largest deviation.
  std::string explanation;
};

/// Checks a shape by its RMS deviation, at its own arc lengths. A malformed shape (different
/// numbers of points and arc lengths, fewer than two, not finite, arc lengths that neither increase
/// nor decrease, or that leave the rod by more than 1e-6 l) is not near, and the explanation states
/// the defect.
/// @param tolerance  share of the rod's length or of_deflection() [-], > 0
/// @throws std::invalid_argument for a tolerance that is not > 0, InputError, ConvergenceError
[[nodiscard]] ShapeTestOutcome shape_near(const Shape& shape, const Scene& scene,
                                          ToleranceShare tolerance);

/// Checks a shape by its largest deviation of a point, else as shape_near().
[[nodiscard]] ShapeTestOutcome shape_within(const Shape& shape, const Scene& scene,
                                            ToleranceShare tolerance);

}  // namespace dlo::compare
