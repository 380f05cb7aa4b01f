#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <tuple>

#include "../helpers.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"
#include "polygons.hpp"

namespace dlo::test {

using force_model::BendingLaw;
using force_model::Grip;
using force_model::GripHold;
using force_model::Rod;
using force_model::StepOptions;
using force_model::Stepper;

/// Mean length of the rods below [m].
inline constexpr double length = 0.5;

enum class Walls { none, two };
enum class Space { plane, full };

using Variant = std::tuple<BendingLaw, Stepper, GripHold, Walls, Space>;

/// Returns a rod with forces of the order of 1 N, so that forces can be compared with 1 N.
inline Rod random_rod(unsigned seed, Eigen::Index points, const Variant& variant) {
  const auto& [law, stepper, hold, walls, space] = variant;
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double L = length / static_cast<double>(points - 1);
  Rod rod;
  rod.rest_lengths.resize(points - 1);
  for (double& rest : rod.rest_lengths) rest = L * (1 + 0.2 * uniform(engine));
  rod.c_c = 1;
  rod.bending = {law, law == BendingLaw::hooke ? 0.1 * L * L : 0.1};
  rod.loads.resize(3, points);
  for (double& load : rod.loads.reshaped()) load = 0.1 * uniform(engine);
  Grip first{.first_point = 0, .hold = hold, .stiffness = 3};
  first.targets.resize(3, std::min<Eigen::Index>(2, points));
  for (double& target : first.targets.reshaped()) target = 0.01 * uniform(engine);
  first.targets.rightCols(1).row(0).array() += L;
  Grip last{.first_point = points - 1, .hold = hold, .stiffness = 2};
  last.targets.setConstant(3, 1, 0.4 * length);
  rod.grips = {first};
  if (points > 3) rod.grips.push_back(last);
  if (walls == Walls::two) {
    rod.walls = {{.point = {0, 0.01, 0}, .normal = {0.6, 0.8, 0}, .stiffness = 5},
                 {.point = {0.1, 0, 0}, .normal = {0, -1, 0}, .stiffness = 2}};
    // In the way of points and, in the midst of segments, of the rod between them.
    rod.solids = {{obstacle::Body::sphere({0.3 * length, 0.02, 0}, 0.1), 4, 3},
                  {obstacle::Body::cylinder({0.6 * length, 0, 0}, {0, 0, 1}, 0.05), 3, 1}};
  }
  if (space == Space::plane) {
    rod.loads.row(2).setZero();
    for (Grip& grip : rod.grips) grip.targets.row(2).setZero();
  }
  return rod;
}

inline Eigen::Matrix3Xd random_points(unsigned seed, Eigen::Index points, Space space) {
  const double L = length / static_cast<double>(points - 1);
  Eigen::Matrix3Xd result = random_polygon(seed, points - 1, L, 0.2);
  if (space == Space::plane) result.row(2).setZero();
  return result;
}

inline StepOptions options_for(Stepper stepper, const Rod& rod) {
  StepOptions options;
  options.policy = force_model::policy(stepper);
  const double L = rod.rest_lengths.minCoeff();
  options.c_F = 0.02 * L;  // of order 1 N: movements of a fiftieth of a segment
  options.c_h = 0.7;
  options.l_s = 0.01 * L;
  return options;
}

}  // namespace dlo::test
