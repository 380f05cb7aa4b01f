#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::test {

/// Similarity transformation of a rod: factors of its lengths and stiffnesses, a rotation and a
/// translation. of() does not transform obstacles, line loads, couples, drag, a second or axial
/// stiffness, and natural strains of sections.
struct Placement {
  double length = 1;
  double stiffness = 1;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();

  [[nodiscard]] double force() const { return stiffness / (length * length); }
  [[nodiscard]] double energy() const { return stiffness / length; }

  [[nodiscard]] energy_model::Problem of(energy_model::Problem problem) const {
    problem.length *= length;
    problem.bending_stiffness *= stiffness;
    problem.torsional_stiffness *= stiffness;
    problem.weight_per_length = force() / length * (turn * problem.weight_per_length);
    for (Eigen::Vector3d& strain : problem.natural_strains) strain /= length;
    for (energy_model::Grip& grip : problem.grips) {
      grip.at *= length;
      grip.position = shift + length * (turn * grip.position);
      if (grip.direction) grip.direction = turn * *grip.direction;
      if (grip.frame && grip.frame->d1) grip.frame->d1 = turn * *grip.frame->d1;
    }
    for (energy_model::Load& load : problem.loads) {
      load.at *= length;
      load.force = force() * (turn * load.force);
    }
    for (energy_model::Section& section : problem.sections) {
      section.begin *= length;
      section.end *= length;
      section.bending_stiffness *= stiffness;
      section.torsional_stiffness *= stiffness;
      section.weight_per_length = force() / length * (turn * section.weight_per_length);
    }
    return problem;
  }

  /// Largest differences of two results at 11 arc lengths and at the grips, in the units of the
  /// first one.
  struct Differences {
    double points = 0, curvature = 0, energy = 0, force = 0, torque = 0;
  };

  /// @param own  result of a rod of unit length
  /// @param placed  result of the same rod, transformed by of()
  [[nodiscard]] Differences differences(const energy_model::Equilibrium& own,
                                        const energy_model::Equilibrium& placed) const {
    std::vector<double> s = energy_model::equal_arc_lengths(1, 11);
    const energy_model::Samples a = own.sample(s);
    for (double& at : s) at *= length;
    const energy_model::Samples b = placed.sample(s);
    Differences found;
    const Eigen::Matrix3Xd points = turn.transpose() * (b.points.colwise() - shift) / length;
    found.points = (points - a.points).colwise().norm().maxCoeff();
    const Eigen::Matrix3Xd curvature = length * turn.transpose() * b.curvature;
    found.curvature = (curvature - a.curvature).colwise().norm().maxCoeff();
    found.energy = std::abs(placed.energy.total() / energy() - own.energy.total());
    for (std::size_t i = 0; i < own.grips.size(); ++i) {
      const energy_model::Reaction& grip = placed.grips.at(i);
      const Eigen::Vector3d force_here = turn.transpose() * grip.force / force();
      const Eigen::Vector3d torque_here = turn.transpose() * grip.torque / energy();
      found.force = std::max(found.force, (force_here - own.grips[i].force).norm());
      found.torque = std::max(found.torque, (torque_here - own.grips[i].torque).norm());
    }
    return found;
  }
};

}  // namespace dlo::test
