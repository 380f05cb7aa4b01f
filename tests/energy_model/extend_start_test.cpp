// Tests of the example of a start of the search in energy_model/doc/extend.md: a helix between two
// clamps.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problem/split.hpp"
#include "problems.hpp"
#include "solved.hpp"
#include "span/span_solver.hpp"

namespace dlo::energy_model {
namespace {

// [page]
/// Returns a helix of whole turns around the chord to the last grip, as long as the span: a start
/// for clamps that are nearer than the rod is long. Only tangents count, unit and by growing s.
TangentField helix_field(const Span& span, double turns) {
  const Eigen::Vector3d chord = span.holds.back().offset;
  const Eigen::Vector3d axis = chord.normalized();
  const Eigen::Vector3d across = axis.unitOrthogonal();
  const double along = chord.norm() / span.length;  // cosine of the pitch
  const double aside = std::sqrt(1 - along * along);
  return [=, length = span.length](const Eigen::VectorXd& s) {
    Eigen::Matrix3Xd tangents(3, s.size());
    for (Eigen::Index q = 0; q < s.size(); ++q) {
      const double angle = 2 * std::numbers::pi * turns * s[q] / length;
      tangents.col(q) =
          along * axis + aside * (std::cos(angle) * across + std::sin(angle) * axis.cross(across));
    }
    return StartShape(tangents);
  };
}

/// Downhill from there to a minimum, with as many terms as it takes, certified.
SpanSolution minimum_near_helix(const Span& span, double turns) {
  SpanWorkspace workspace;
  SpanOptions options;
  options.start.field = helix_field(span, turns);
  options.start.approach = Approach::descend;
  return solve_span(span, options, workspace).front();
}
// [end of page]

TEST(ExtendStart, AHelixLeadsToNothingLowerThanTheSearch) {
  Problem problem = test::two_clamps(5, 0.7);
  problem.grips[1].direction = Eigen::Vector3d(1, 0.3, 0.4);
  const Span span = split(problem).front().span;
  ASSERT_FALSE(span.planar);
  const Equilibrium lowest = test::converged(solve_energy(problem));
  for (const double turns : {1.0, -1.0}) {
    const SpanSolution found = test::converged(minimum_near_helix(span, turns));
    EXPECT_GT(found.energy, lowest.energy.total() - 1e-9);
  }
}

}  // namespace
}  // namespace dlo::energy_model
