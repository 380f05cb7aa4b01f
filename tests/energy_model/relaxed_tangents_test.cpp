// Polygons of a round rod's tangents, from which multiple shooting starts.

#include "kirchhoff/relaxed_tangents.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/grip_gaps.hpp"
#include "kirchhoff/polygon_starts.hpp"
#include "kirchhoff/rod_mesh.hpp"
#include "kirchhoff/rod_span.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a rod of unit length and stiffness between a clamp and the grip of its end.
RodSpan held_rod(double weight, const Grip& end, const std::vector<Grip>& between = {}) {
  Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -weight, 0};
  problem.grips = {{0, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX()}};
  problem.grips.insert(problem.grips.end(), between.begin(), between.end());
  problem.grips.push_back(end);
  return cut_at_clamps(problem).front();
}

Grip clamp_at_end(double x, const Eigen::Vector3d& direction) { return {1, {x, 0, 0}, direction}; }

Eigen::Matrix3Xd tangents_of_start(const std::vector<Eigen::Quaterniond>& frames) {
  Eigen::Matrix3Xd tangents(3, static_cast<Eigen::Index>(frames.size()));
  for (Eigen::Index i = 0; i < tangents.cols(); ++i) {
    tangents.col(i) = frames[static_cast<std::size_t>(i)] * Eigen::Vector3d::UnitZ();
  }
  return tangents;
}

/// Returns the largest sine of the angle between a tangent and the sum of its neighbours, weighted
/// by 1 / h, and the force.
double largest_angle(const RodSpan& span, const RodMesh& mesh, const RelaxedTangents& polygon) {
  const Eigen::Matrix3Xd& t = polygon.tangents;
  const auto pull_of = [&](const RodSpan::Clamp* clamp, Eigen::Index i) -> Eigen::Vector3d {
    if (clamp == nullptr) return Eigen::Vector3d::Zero();
    return 2 / mesh.width(i) * clamp->direction;
  };
  const auto between = [&](Eigen::Index i) { return 2 / (mesh.width(i) + mesh.width(i + 1)); };
  const Eigen::Index last = t.cols() - 1;
  double largest = 0;
  for (Eigen::Index i = 0; i <= last; ++i) {
    Eigen::Vector3d pull = mesh.width(i) * polygon.force.col(i);
    pull += i > 0 ? between(i - 1) * t.col(i - 1) : pull_of(span.clamp_at(0), i);
    pull += i < last ? between(i) * t.col(i + 1) : pull_of(span.clamp_at(span.length), i);
    largest = std::max(largest, pull.normalized().cross(t.col(i)).norm());
  }
  return largest;
}

TEST(RelaxedTangents, CloseTheirGapsAndComeToRest) {
  const std::vector<Grip> pin = {{0.4, {0.3, 0.1, 0.05}, std::nullopt}};
  const std::vector<RodSpan> spans = {
      held_rod(1, clamp_at_end(0.4, {1, 0.3, 0.1})),    // arches, nearly any way around the x axis
      held_rod(0, clamp_at_end(0.8, {1, 0, 0})),        // any way around it, exactly
      held_rod(300, clamp_at_end(0.5, {0, 1, 0})),      // hangs
      held_rod(1, clamp_at_end(0.9999, {1, 0.1, 0})),   // taut
      held_rod(30, {1, {0.5, 0, 0}, std::nullopt}),     // a pin at its end
      held_rod(3, clamp_at_end(0.6, {0, 0, -1}), pin),  // and between two clamps
      held_rod(10, {1, {0, 0.2, 0}, Eigen::Vector3d(-1, 0, 0)})};
  for (std::size_t k = 0; k < spans.size(); ++k) {
    const RodSpan& span = spans[k];
    const RodMesh mesh = make_mesh(span, longest_interval(span, total_load(span)));
    for (const Motion motion : {Motion::in_plane, Motion::in_space}) {
      if (motion == Motion::in_plane && !span.plane) continue;
      for (const auto& start : polygon_starts(span, mesh, motion)) {
        const RelaxedTangents polygon =
            relax_tangents(span, mesh, tangents_of_start(start), motion, Deadline(10));
        for (const GripGap& of : grip_gaps(span, mesh)) {
          Eigen::Vector3d gap = -of.chord;
          for (Eigen::Index i = of.first; i < of.end; ++i) {
            gap += mesh.width(i) * polygon.tangents.col(i);
          }
          EXPECT_TRUE(of.closed(gap)) << "span " << k << ": " << gap.norm();
        }
        // Ten times the last step of a tangent.
        EXPECT_LT(largest_angle(span, mesh, polygon), 1e-3) << "span " << k;
      }
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
