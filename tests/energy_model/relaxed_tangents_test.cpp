// Tests of the polygons of a round rod's tangents from which multiple shooting starts.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "base/deadline.hpp"
#include "dlo/energy_model/problem.hpp"
#include "kirchhoff/relaxed_polygon.hpp"
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

/// Returns the largest sine of the angle between a tangent and the sum of its neighbours, weighted
/// by 1 / h, and the force.
double largest_angle(const RodSpan& span, const RodMesh& mesh, const RelaxedPolygon& polygon) {
  const Eigen::Matrix3Xd t = polygon.tangents();
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
        const RelaxedPolygon polygon = relax_polygon(span, mesh, start, motion, Deadline(10));
        const Eigen::Matrix3Xd tangents = polygon.tangents();
        for (const ChordConstraint& of : grip_gaps(span, mesh)) {
          Eigen::Vector3d gap = -of.chord;
          for (Eigen::Index i = of.first; i < of.end; ++i) {
            gap += mesh.width(i) * tangents.col(i);
          }
          EXPECT_TRUE(of.closed(gap)) << "span " << k << ": " << gap.norm();
        }
        // The limit is ten times the last step of a tangent.
        EXPECT_LT(largest_angle(span, mesh, polygon), 1e-3) << "span " << k;
      }
    }
  }
}

TEST(RelaxedTangents, HaveTheEnergyOfTheirJointsAndLoads) {
  const RodSpan span = held_rod(2, clamp_at_end(0.7, {1, 0, 0}));
  const RodMesh mesh = make_mesh(span, 0.05);
  const auto start = polygon_starts(span, mesh, Motion::in_plane)[2];
  const RelaxedPolygon polygon = relax_polygon(span, mesh, start, Motion::in_plane, Deadline(10));
  const Eigen::Matrix3Xd t = polygon.tangents();
  const Eigen::Index count = t.cols();
  const double h = mesh.width(0);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  double energy = 2 / h * (1 - t.col(0).dot(x) + 1 - t.col(count - 1).dot(x));
  double height = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (i > 0) energy += (1 - t.col(i).dot(t.col(i - 1))) / h;
    energy += 2 * h * (height + h / 2 * t(1, i));
    height += h * t(1, i);
  }
  EXPECT_NEAR(polygon.energy, energy, 1e-9);
  EXPECT_NEAR(t.row(2).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace dlo::energy_model
