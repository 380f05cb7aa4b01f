#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "../../helpers.hpp"
#include "../../says.hpp"
#include "dlo/compare/explanation.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene_file.hpp"

namespace dlo::test {

/// Returns a rod of 0.5 kg/m whose clamp points 20 degrees upwards. @param rod  additional keys of
/// the rod
inline compare::Scene clamped(const std::string& rod = "") {
  return compare::parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 1\nmass_per_length = 0.5\n" + rod +
          "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"20 deg\"\n",
      "clamped.toml");
}

/// Returns points as a shape read from a file.
inline compare::MeasuredShape file_shape(Eigen::Matrix3Xd points) {
  compare::MeasuredShape shape;
  shape.file = "mine.csv";
  shape.points = std::move(points);
  return shape;
}

/// Returns the rod of the energy model at equal arc lengths as a shape read from a file.
inline compare::MeasuredShape exact_file(const compare::Scene& scene, int count = 41) {
  return file_shape(compare::solve_reference(scene, compare::Model::energy)
                        .sample(compare::equal_arc_lengths(scene.length, count))
                        .points);
}

/// Returns an arch on two clamps that point up and down; it is stable if it is stiff, and otherwise
/// falls out of its plane.
inline compare::Scene clamped_arch(double stiffness) {
  return compare::parse_scene(
      "[rod]\nlength = 1\nmass_per_length = 0.5\nbending_stiffness = " + std::to_string(stiffness) +
          "\n[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"90 deg\"\n[[gripper]]\nat = "
          "1\nposition = [0.5, 0, 0]\ndirection = \"-90 deg\"\n",
      "arch.toml");
}

/// Judgement of a shape, and its explanations.
struct JudgedShape {
  compare::ShapeJudgement judgement;
  std::vector<compare::Explanation> explanations;
};

/// Judges a shape without a search for E*, and explains it if it fails as a rod, even if it passes
/// as a chain.
/// @param share    allowed deviation divided by the length [-]
/// @param largest  whether the largest deviation is judged, not the RMS
inline JudgedShape judge_shape(const compare::Scene& scene, const compare::MeasuredShape& shape,
                               double share = 0.01, bool largest = false) {
  const compare::ShapeCheckOptions options{.modulus = compare::ModulusSearch::no};
  const compare::ShapeCheck check = compare::check_shape(scene, shape, options);
  const compare::ShapeTolerance tolerance{.allowed_m = share * scene.length, .largest = largest};
  JudgedShape outcome;
  if (!compare::judge(check, tolerance).passes()) {
    outcome.explanations = compare::explain_shape(scene, shape, check, options);
  }
  outcome.judgement = compare::with_explanation(
      compare::judge_as_chain(scene, check, tolerance).judgement, outcome.explanations, tolerance);
  return outcome;
}

/// Expects that the shape fails for a tolerance of 1 % of the length, that the best explanation and
/// the reason contain these words, and that the best explanation leaves an RMS below `left_m`.
inline void expect_cause(const std::string& what, const compare::Scene& scene,
                         const compare::MeasuredShape& shape, const std::vector<std::string>& words,
                         double left_m = 1e-3) {
  SCOPED_TRACE(what);
  const JudgedShape outcome = judge_shape(scene, shape);
  EXPECT_FALSE(outcome.judgement.passes());
  ASSERT_FALSE(outcome.explanations.empty()) << outcome.judgement.reason;
  const compare::Explanation& best = outcome.explanations.front();
  for (const std::string& word : words) {
    EXPECT_TRUE(has_all(best.cause, {word}));
    EXPECT_TRUE(has_all(outcome.judgement.reason, {word}));
  }
  EXPECT_LT(best.rms_m, left_m);
}

}  // namespace dlo::test
