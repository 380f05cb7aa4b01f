#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/polygon.hpp"

namespace dlo::test {

/// Elastic polygon of a round rod whose ends two clamps hold with their frames, with stiff springs
/// as obstacles. It shares neither unknowns nor contacts with the energy model. Clamps hold the
/// middles of the end segments.
struct PolygonOfRod {
  energy_model::PolygonProblem problem;
  Eigen::Matrix3Xd points;  ///< points of the rod's shape, the initial guess of at_rest() [m]

  /// @param segments  number of segments between the clamps
  PolygonOfRod(const energy_model::Problem& rod, const energy_model::Equilibrium& shape,
               Eigen::Index segments) {
    const Eigen::Index count = segments + 2;
    const double L = rod.length / static_cast<double>(segments);
    const double weight = rod.weight_per_length.norm() * rod.length * rod.length * rod.length;
    // Springs yield by about 1e-4 l under the forces that bend the rod and its weight.
    const double stiff = 1e4 * (40 * rod.bending_stiffness + weight) / (rod.length * rod.length);
    problem.rest_lengths = Eigen::VectorXd::Constant(count - 1, L);
    problem.stretch_stiffness = stiff;
    problem.stiffness = rod.bending_stiffness;
    problem.node_forces.setZero(3, count);
    problem.node_forces.middleCols(1, segments).colwise() = L * rod.weight_per_length;
    std::vector<double> s;
    for (Eigen::Index i = 0; i < count; ++i) {
      s.push_back(std::clamp((static_cast<double>(i) - 0.5) * L, 0.0, rod.length));
    }
    points = shape.sample(s).points;
    const auto hold = [&](Eigen::Index point, const energy_model::Grip& grip, double way) {
      problem.held.push_back({point, grip.position + way * L / 2 * grip.direction->normalized()});
      points.col(point) = problem.held.back().position;
    };
    hold(0, rod.grips.front(), -1);
    hold(1, rod.grips.front(), 1);
    hold(count - 2, rod.grips.back(), -1);
    hold(count - 1, rod.grips.back(), 1);
    for (const energy_model::Obstacle& obstacle : rod.obstacles) {
      const int samples = obstacle::samples_per_segment(obstacle.body, L);
      problem.obstacles.push_back({obstacle.body, stiff * L / rod.length * 64, samples});
    }
    const Eigen::Matrix3Xd d1 = shape.sample(std::array{0.0, rod.length}).d1;
    problem.twists = {{0, count - 2, d1.col(0), d1.col(1), rod.length / rod.torsional_stiffness,
                       shape.twists.at(0).angle}};
  }

  [[nodiscard]] energy_model::PolygonResult at_rest() const {
    energy_model::PolygonOptions options;
    options.tolerance = 1e-7;
    options.in_stages = false;
    return energy_model::solve_polygon(problem, points, options);
  }
};

}  // namespace dlo::test
