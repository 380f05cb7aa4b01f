#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "../helpers.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"
#include "solved.hpp"

namespace dlo::test {

/// Checks the contacts of a certified shape by its samples and forces alone: no sample is within
/// a rigid obstacle, the ends and the middle of every contact are on the surface of its obstacle
/// (to 1e-8 of the length), and no force pulls (to 1e-6 of the largest force).
inline void expect_only_pushed(const energy_model::Problem& problem,
                               const energy_model::Equilibrium& shape) {
  const double l = problem.length;
  const auto dense = shape.sample(energy_model::equal_arc_lengths(l, 7919)).points;
  double largest = problem.weight_per_length.norm() * l + problem.bending_stiffness / (l * l);
  for (const energy_model::Reaction& grip : shape.grips) {
    largest = std::max(largest, grip.force.norm());
  }
  for (const energy_model::Obstacle& obstacle : problem.obstacles) {
    if (std::isfinite(obstacle.stiffness)) continue;
    EXPECT_GT(obstacle.body.clearances(dense).minCoeff(), -1e-8 * l);
  }
  for (const energy_model::ContactPart& contact : shape.contacts) {
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();
    for (const double at : {contact.begin, (contact.begin + contact.end) / 2, contact.end}) {
      const auto gap = problem.obstacles[contact.obstacle].body.gap(point_at(shape, at));
      EXPECT_NEAR(gap.value, 0, 1e-8 * l) << at;
      normals += gap.gradient;
    }
    EXPECT_GE(contact.force.dot(normals), -1e-6 * largest) << contact.begin;
    EXPECT_GE(std::min(contact.begin_force, contact.end_force), -1e-6 * largest) << contact.begin;
  }
}

}  // namespace dlo::test
