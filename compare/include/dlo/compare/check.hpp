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

/// Whether it is looked for what is wrong with a shape that fails.
enum class Explaining { yes, no };

/// What is asked of a shape.
struct CheckRequest {
  std::optional<ShapeTolerance> tolerance;  ///< none: default_tolerance()
  Explaining explaining = Explaining::yes;  ///< pass and fail do not depend on it
  ShapeCheckOptions shape;                  ///< how it is compared
};

/// A shape against its scene's energy model, judged: what `dlo check` says, and Python and
/// GoogleTest with it.
struct CheckResult {
  Scene scene;                                    ///< that it was held against
  ShapeCheck check;                               ///< how far it is away
  ShapeTolerance tolerance;                       ///< that it was judged by
  ShapeJudgement judgement;                       ///< pass or fail, with its reason
  std::vector<Explanation> explanations;          ///< of a shape that is not near, the best first
  std::optional<Explanation> supersedes_modulus;  ///< what explains it better than any stiffness
  PoseFreedom pose = PoseFreedom::known;          ///< what was unknown of the shape's frame
  std::vector<std::string> notes;                 ///< what of the shape was taken for what
  /// TrivialShape::deflection_m; NaN unless the shape passes or the tolerance is a share of it.
  double deflection_m = std::numeric_limits<double>::quiet_NaN();

  /// Within the tolerance.
  [[nodiscard]] bool passes() const { return judgement.passes(); }
};

/// Of a shape that passes though another stiffness would come nearer by far: why both hold. Empty
/// where that is not so.
[[nodiscard]] std::string other_stiffness_within(const CheckResult& result);

/// Compares, judges and, where the shape is not within the tolerance, explains.
/// @throws InputError, ConvergenceError
[[nodiscard]] CheckResult check(const Scene& scene, const MeasuredShape& shape,
                                const CheckRequest& request = {});

/// Tolerance of a test: a share of the rod's length or of its deflection.
struct ToleranceShare {
  double share = 0;            ///< [-], > 0
  bool of_deflection = false;  ///< of TrivialShape::deflection_m, not of the length

  /// A share of the length [-]. Implicit, so that tests may pass a number.
  ToleranceShare(double of_length) : share(of_length) {}  // NOLINT(google-explicit-constructor)
  /// A share of the length or of the deflection [-].
  ToleranceShare(double value, bool is_of_deflection)
      : share(value), of_deflection(is_of_deflection) {}
};

/// Returns a share of the deflection, for stiff rods: EXPECT_SHAPE_NEAR(shape, scene,
/// of_deflection(0.05)).
[[nodiscard]] inline ToleranceShare of_deflection(double share) { return {share, true}; }

/// Whether a shape is a scene's, for a test.
struct ShapeNear {
  bool near = false;        ///< check() passes
  std::string explanation;  ///< its reason; then, on a line of its own, where it is worst
};

/// check() by its RMS, at the shape's arc lengths. One that is undefined (other numbers of points
/// and arc lengths, fewer than two, not finite, arc lengths that do not grow or leave the rod by
/// more than 1e-6 l) is not near, and the explanation says why.
/// @param tolerance  share of the rod's length or of_deflection() [-], > 0
/// @throws std::invalid_argument for such a tolerance, InputError, ConvergenceError
[[nodiscard]] ShapeNear shape_near(const Shape& shape, const Scene& scene,
                                   ToleranceShare tolerance);

/// The same by the largest distance of a point.
[[nodiscard]] ShapeNear shape_within(const Shape& shape, const Scene& scene,
                                     ToleranceShare tolerance);

}  // namespace dlo::compare
