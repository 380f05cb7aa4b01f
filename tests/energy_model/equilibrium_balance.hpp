#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::test {

/// Violations of the conditions of equilibrium by a shape, from its samples and reactions alone.
struct BalanceDefects {
  /// |sum of all forces on the rod| over the largest of them, at least EI/l^2.
  double force = 0;
  /// |sum of all torques about the rod's begin| over largest force times l plus largest torque, at
  /// least EI/l.
  double torque = 0;
  /// Largest |EI t x t' + GJ tau t - torque of all that lies beyond|, divided by the scale of
  /// `torque`. With material directors only the components across t, with
  /// EI_1 (u1 - n1) d1 + EI_2 (u2 - n2) d2 in place of EI t x t' + GJ tau t.
  double moment = 0;
  double grips = 0;     ///< largest error of positions over l, and of unit tangents
  double integral = 0;  ///< largest |r(b) - r(a) - int t ds| over l, and ||t| - 1|

  [[nodiscard]] double worst() const {
    const double kinematic = std::max(grips, integral);
    return std::max({force, torque, moment, kinematic});
  }
};

/// Sum of the forces on a part of the rod, and of all torques about the origin.
struct CarriedLoad {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_about_origin = Eigen::Vector3d::Zero();

  void add(const Eigen::Vector3d& at, const Eigen::Vector3d& own_force) {
    force += own_force;
    torque_about_origin += at.cross(own_force);
  }
};

/// Returns the rod's section at an arc length.
inline energy_model::Section section_at(const energy_model::Problem& problem, double at) {
  for (const energy_model::Section& section : problem.sections) {
    if (section.begin < at && at < section.end) return section;
  }
  return {0,
          problem.length,
          problem.bending_stiffness,
          problem.torsional_stiffness,
          problem.weight_per_length,
          problem.bending_stiffness_2};
}

/// Returns Problem::natural_strains at an arc length; natural strains of sections are ignored.
inline Eigen::Vector3d natural_strain_at(const energy_model::Problem& problem, double at) {
  Eigen::Vector3d natural = Eigen::Vector3d::Zero();
  for (std::size_t j = 0; j < problem.natural_strains.size(); ++j) {
    natural += std::legendre(static_cast<unsigned>(j), 2 * at / problem.length - 1) *
               problem.natural_strains[j];
  }
  return natural;
}

/// Returns the bending moment of a rod with material directors, from the derivative of the tangent
/// and d1.
inline Eigen::Vector3d bending_moment(const energy_model::Problem& problem, double at,
                                      const Eigen::Vector3d& t, const Eigen::Vector3d& rate,
                                      const Eigen::Vector3d& d1) {
  const energy_model::Section section = section_at(problem, at);
  const Eigen::Vector3d natural = natural_strain_at(problem, at);
  const Eigen::Vector3d d2 = t.cross(d1);
  // t' = u2 d1 - u1 d2
  const double first = section.bending_stiffness * (-rate.dot(d2) - natural.x());
  const double second = section.bending_stiffness_2.value_or(section.bending_stiffness) *
                        (rate.dot(d1) - natural.y());
  return first * d1 + second * d2;
}

/// Returns the arc lengths of ends, grips, loads, sections, and of the ends of line loads;
/// increasing and unique.
inline std::vector<double> events_of(const energy_model::Problem& problem) {
  std::vector<double> events = {0, problem.length};
  for (const energy_model::Grip& grip : problem.grips) events.push_back(grip.at);
  for (const energy_model::Load& load : problem.loads) events.push_back(load.at);
  for (const energy_model::Section& section : problem.sections) {
    events.push_back(section.begin);
    events.push_back(section.end);
  }
  for (const energy_model::LineLoad& load : problem.line_loads) {
    events.push_back(load.begin);
    events.push_back(load.end);
  }
  std::sort(events.begin(), events.end());
  events.erase(std::unique(events.begin(), events.end()), events.end());
  return events;
}

/// Computes the balance of a shape, without forces of obstacles, drag and loads that follow. The
/// shape is divided into panels of Gauss-Legendre quadrature no longer than `panel`; forces and
/// moments beyond each cut are summed from the far end to the near one.
/// @param panel  length of a panel [m], at most about half the length over which the rod's
/// shape changes
inline BalanceDefects balance_of(const energy_model::Problem& problem,
                                 const energy_model::Equilibrium& shape, double panel) {
  // Nodes and weights of the six-point rule on [-1, 1] (Abramowitz and Stegun, table 25.4).
  constexpr std::array<double, 3> node = {0.238619186083196909, 0.661209386466264514,
                                          0.932469514203152028};
  constexpr std::array<double, 3> weight = {0.467913934572691047, 0.360761573048138608,
                                            0.171324492379170345};
  const double l = problem.length;
  const std::vector<double> events = events_of(problem);
  std::vector<double> cuts = {0};
  for (std::size_t e = 0; e + 1 < events.size(); ++e) {
    const int parts = static_cast<int>(std::ceil((events[e + 1] - events[e]) / panel));
    for (int k = 1; k < parts; ++k) {
      cuts.push_back(events[e] + (events[e + 1] - events[e]) * k / parts);
    }
    cuts.push_back(events[e + 1]);
  }
  std::vector<double> inner;
  std::vector<double> share;  // share of the arc length
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    const double middle = (cuts[c] + cuts[c + 1]) / 2;
    const double half = (cuts[c + 1] - cuts[c]) / 2;
    for (std::size_t k = 0; k < node.size(); ++k) {
      for (const double side : {-1.0, 1.0}) {
        inner.push_back(middle + side * half * node[k]);
        share.push_back(half * weight[k]);
      }
    }
  }
  const energy_model::Samples at_cuts = shape.sample(cuts);
  const energy_model::Samples between = shape.sample(inner);
  const auto point_at = [&](double s) {
    const auto i = std::lower_bound(cuts.begin(), cuts.end(), s) - cuts.begin();
    return Eigen::Vector3d(at_cuts.points.col(i));
  };

  double largest_force = problem.bending_stiffness / (l * l);
  double largest_torque = problem.bending_stiffness / l;
  largest_force = std::max(largest_force, l * problem.weight_per_length.norm());
  for (const energy_model::Load& load : problem.loads) {
    largest_force = std::max(largest_force, load.force.norm());
    largest_torque = std::max(largest_torque, load.torque.norm());
  }
  for (const energy_model::LineLoad& load : problem.line_loads) {
    largest_force = std::max(largest_force, load.force_between(0, l).norm());
  }
  for (const energy_model::Reaction& grip : shape.grips) {
    largest_force = std::max(largest_force, grip.force.norm());
    largest_torque = std::max(largest_torque, grip.torque.norm());
  }
  const double torque_unit = largest_torque + l * largest_force;

  BalanceDefects defects;
  const auto raise = [](double& worst, double value) {
    worst = value <= worst ? worst : value;  // NaN raises it too
  };
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    const energy_model::Grip& grip = problem.grips[i];
    raise(defects.grips, (point_at(grip.at) - grip.position).norm() / l);
    if (!grip.direction) continue;
    const auto at = std::lower_bound(cuts.begin(), cuts.end(), grip.at) - cuts.begin();
    raise(defects.grips, (at_cuts.tangents.col(at) - grip.direction->normalized()).norm());
  }

  constexpr std::size_t per_panel = 2 * node.size();
  CarriedLoad beyond;
  for (std::size_t c = cuts.size(); c-- > 0;) {
    const auto here = static_cast<Eigen::Index>(c);
    const Eigen::Vector3d point = at_cuts.points.col(here);
    for (std::size_t i = 0; i < problem.grips.size(); ++i) {
      if (problem.grips[i].at != cuts[c]) continue;
      beyond.add(point, shape.grips[i].force);
      beyond.torque_about_origin += shape.grips[i].torque;
    }
    for (const energy_model::Load& load : problem.loads) {
      if (load.at != cuts[c]) continue;
      beyond.add(point, load.force);
      beyond.torque_about_origin += load.torque;
    }
    raise(defects.integral, std::abs(at_cuts.tangents.col(here).norm() - 1));
    if (c == 0) break;
    Eigen::Vector3d run = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < per_panel; ++k) {
      const auto q = static_cast<Eigen::Index>((c - 1) * per_panel + k);
      const double ds = share[static_cast<std::size_t>(q)];
      run += ds * between.tangents.col(q);
      raise(defects.integral, std::abs(between.tangents.col(q).norm() - 1));
    }
    raise(defects.integral, (point - at_cuts.points.col(here - 1) - run).norm() / l);
    // Where something happens, the curvature has a kink or a jump.
    const bool event = std::binary_search(events.begin(), events.end(), cuts[c]);
    if (!event && has_material_directors(problem)) {
      const Eigen::Vector3d tangent = at_cuts.tangents.col(here);
      const Eigen::Vector3d carried = beyond.torque_about_origin - point.cross(beyond.force);
      const Eigen::Vector3d moment =
          bending_moment(problem, cuts[c], tangent, at_cuts.curvature.col(here),
                         at_cuts.d1.col(here)) -
          (carried - carried.dot(tangent) * tangent);
      raise(defects.moment, moment.norm() / torque_unit);
    } else if (!event) {
      const Eigen::Vector3d tangent = at_cuts.tangents.col(here);
      Eigen::Vector3d moment = section_at(problem, cuts[c]).bending_stiffness *
                               tangent.cross(Eigen::Vector3d(at_cuts.curvature.col(here)));
      for (const energy_model::TwistedPart& part : shape.twists) {
        if (part.begin < cuts[c] && cuts[c] < part.end) moment += part.torque * tangent;
      }
      const Eigen::Vector3d carried = beyond.torque_about_origin - point.cross(beyond.force);
      raise(defects.moment, (moment - carried).norm() / torque_unit);
    }
    const Eigen::Vector3d own_weight =
        section_at(problem, (cuts[c - 1] + cuts[c]) / 2).weight_per_length;
    for (std::size_t k = 0; k < per_panel; ++k) {
      const auto q = static_cast<Eigen::Index>((c - 1) * per_panel + k);
      const double at = inner[static_cast<std::size_t>(q)];
      Eigen::Vector3d own = own_weight;
      for (const energy_model::LineLoad& load : problem.line_loads) {
        if (at > load.begin && at < load.end)
          own += load.at_begin + (at - load.begin) * load.slope();
      }
      beyond.add(between.points.col(q), share[static_cast<std::size_t>(q)] * own);
    }
  }
  defects.force = beyond.force.norm() / largest_force;
  const Eigen::Vector3d origin = at_cuts.points.col(0);
  defects.torque = (beyond.torque_about_origin - origin.cross(beyond.force)).norm() / torque_unit;
  return defects;
}

}  // namespace dlo::test
