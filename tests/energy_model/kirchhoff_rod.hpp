#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "../helpers.hpp"
#include "equilibrium_balance.hpp"
#include "runge_kutta.hpp"
#include "solved.hpp"

namespace dlo::test {

/// Returns the matrix with hat(u) v = u x v.
inline Eigen::Matrix3d cross_product_matrix(const Eigen::Vector3d& u) {
  Eigen::Matrix3d hat;
  hat << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
  return hat;
}

/// Result of the integration of a rod from its first grip under all forces: the final point, the
/// remaining force and moment there, which are zero for an equilibrium, and the largest distance
/// from the sampled points of the shape.
struct RodEnd {
  Eigen::Vector3d point, force, moment;
  double apart = 0;
};

/// Integrates Kirchhoff's equations r' = t, R' = R hat(u), m' = n x t, n' = -w along a rod by the
/// classical Runge-Kutta method, with the reactions of its grips, the weight and the forces
/// of the loads. Couples, line loads and obstacles are not counted.
/// @param frame  directors (d1, d2, t) at the first grip, at s = 0
inline RodEnd integrate_kirchhoff(const energy_model::Problem& problem,
                                  const energy_model::Equilibrium& shape,
                                  const Eigen::Matrix3d& frame) {
  using State = Eigen::Matrix<double, 15, 1>;  // r, R, m
  const std::vector<double> events = events_of(problem);
  State y;
  y << problem.grips[0].position, frame.reshaped(), Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  RodEnd end;
  for (std::size_t e = 0; e < events.size(); ++e) {
    for (std::size_t g = 0; g < problem.grips.size(); ++g) {
      if (problem.grips[g].at != events[e]) continue;
      n -= shape.grips[g].force;
      y.tail<3>() -= shape.grips[g].torque;
    }
    for (const energy_model::Load& load : problem.loads) {
      if (load.at == events[e]) n -= load.force;
    }
    if (e + 1 == events.size()) break;
    const energy_model::Section section = section_at(problem, (events[e] + events[e + 1]) / 2);
    const Eigen::Vector3d stiffness(section.bending_stiffness,
                                    section.bending_stiffness_2.value_or(section.bending_stiffness),
                                    section.torsional_stiffness);
    const auto rates = [&](double s, const State& at) {
      const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3d>(at.data() + 3);
      Eigen::Vector3d u = natural_strain_at(problem, s);
      if (section.natural_curvature) u.head<2>() = *section.natural_curvature;
      if (section.natural_twist) u.z() = *section.natural_twist;
      u += (R.transpose() * at.tail<3>()).cwiseQuotient(stiffness);
      const Eigen::Vector3d own = n - (s - events[e]) * section.weight_per_length;
      State rate;
      rate << R.col(2), (R * cross_product_matrix(u)).reshaped(),
          own.cross(Eigen::Vector3d(R.col(2)));
      return rate;
    };
    constexpr int steps = 1600;
    const double h = (events[e + 1] - events[e]) / steps;
    for (int k = 0; k < steps; ++k) {
      const double s = events[e] + k * h;
      y = runge_kutta(rates, s, y, h);
      if (k % 100 != 0 && k + 1 != steps) continue;
      const Eigen::Vector3d point = point_at(shape, std::min(s + h, problem.length));
      end.apart = std::max(end.apart, (point - y.head<3>()).norm());
    }
    n -= (events[e + 1] - events[e]) * section.weight_per_length;
  }
  end.point = y.head<3>();
  end.force = n;
  end.moment = y.tail<3>();
  return end;
}

}  // namespace dlo::test
