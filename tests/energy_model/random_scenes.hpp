#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/exact.hpp"
#include "equilibrium_balance.hpp"
#include "random_problems.hpp"

namespace dlo::test {

/// Comparison of two solutions of one problem.
enum class Agreement {
  same,         ///< equal points to 1e-8 l at 101 arc lengths
  image,        ///< the same curvature and energy: a mirror image, or rotated about a free axis
  both_stable,  ///< two different equilibria, each proven stable
  contradict,   ///< none of these
  missing       ///< one of them at least did not converge
};

/// Results of both models for one problem.
struct ComparedScene {
  std::uint64_t number = 0;
  energy_model::Equilibrium energy;
  energy_model::Equilibrium exact;
  BalanceDefects energy_defects;
  BalanceDefects exact_defects;
  Agreement agreement = Agreement::missing;
  /// Largest distance of the two shapes' points at equal arc length [l].
  double distance = std::numeric_limits<double>::quiet_NaN();
};

/// Returns the length over which a rod under these forces changes its shape: (EI / force)^(1/2), at
/// most l / 8.
inline double shape_length(const energy_model::Problem& problem,
                           const energy_model::Equilibrium& shape) {
  double force = problem.weight_per_length.norm() * problem.length;
  for (const energy_model::Load& load : problem.loads) force += load.force.norm();
  for (const energy_model::Reaction& grip : shape.grips) {
    force = std::max(force, grip.force.norm());
  }
  const double stiffness = std::min(
      problem.bending_stiffness, problem.bending_stiffness_2.value_or(problem.bending_stiffness));
  const double soft = std::sqrt(stiffness / std::max(force, 1e-300));
  return std::min(problem.length / 8, soft);
}

inline BalanceDefects defects_of(const energy_model::Problem& problem,
                                 const energy_model::Equilibrium& shape) {
  return balance_of(problem, shape, shape_length(problem, shape) / 2);
}

/// Compares two shapes: same shape, its mirror image, or another one.
/// @param[out] distance  largest distance of points at equal arc length [l]
inline Agreement agreement_of(const energy_model::Problem& problem,
                              const energy_model::Equilibrium& a,
                              const energy_model::Equilibrium& b, double& distance) {
  constexpr double same_shape = 1e-8;
  constexpr double same_curvature = 1e-6;  // relative to the largest
  constexpr double stable = -1e-7;         // smallest eigenvalue, rounding included
  const std::vector<double> s = energy_model::equal_arc_lengths(problem.length, 101);
  const energy_model::Samples left = a.sample(s);
  const energy_model::Samples right = b.sample(s);
  distance = (left.points - right.points).colwise().norm().maxCoeff() / problem.length;
  if (distance <= same_shape) return Agreement::same;
  const Eigen::VectorXd one = left.curvature.colwise().norm();
  const Eigen::VectorXd other = right.curvature.colwise().norm();
  const double largest = std::max(one.maxCoeff(), 1 / problem.length);
  const double scale = problem.bending_stiffness / problem.length + std::abs(a.energy.total());
  if ((one - other).cwiseAbs().maxCoeff() <= same_curvature * largest &&
      std::abs(a.energy.total() - b.energy.total()) <= 1e-8 * scale) {
    return Agreement::image;
  }
  // NaN, an eigenvalue that was not computed, proves nothing.
  const bool both_certified = a.smallest_eigenvalue >= stable && b.smallest_eigenvalue >= stable;
  return both_certified ? Agreement::both_stable : Agreement::contradict;
}

/// Start of `exact`. search: `exact` searches. energy: `exact` confirms or corrects the energy
/// model's shape without a search, and does not run if the energy model has not converged.
enum class ExactFrom { search, energy };

/// Whether there is a clamp without a frame between two clamps that hold frames; `exact` refuses
/// this for a round straight rod.
inline bool has_clamp_without_frame_between(const energy_model::Problem& problem) {
  std::vector<const energy_model::Grip*> clamps;
  for (const energy_model::Grip& grip : problem.grips) {
    if (grip.direction) clamps.push_back(&grip);
  }
  std::sort(clamps.begin(), clamps.end(),
            [](const auto* a, const auto* b) { return a->at < b->at; });
  const auto holds = [](const energy_model::Grip* grip) { return grip->frame.has_value(); };
  const auto first = std::find_if(clamps.begin(), clamps.end(), holds);
  const auto last = std::find_if(clamps.rbegin(), clamps.rend(), holds).base();
  return first < last && !std::all_of(first, last, holds);
}

/// Solves a problem by both models and compares the results. A round straight rod with a clamp
/// without a frame between clamps that hold frames, which exact refuses, counts as failed in it.
/// @param time_limit  of each solve [s]
inline ComparedScene compare_models(std::uint64_t number, const energy_model::Problem& problem,
                                    double time_limit, ExactFrom from = ExactFrom::search) {
  ComparedScene scene;
  scene.number = number;
  scene.energy = energy_model::solve_energy(problem, {.time_limit = time_limit});
  const bool energy = succeeded(scene.energy.status);
  if (energy) scene.energy_defects = defects_of(problem, scene.energy);
  if (from == ExactFrom::energy && !energy) return scene;
  if (!has_material_directors(problem) && has_clamp_without_frame_between(problem)) {
    scene.exact.status = energy_model::SolveStatus::failed;
    scene.exact.message = "passes torque on, which exact refuses";
    return scene;
  }
  scene.exact = energy_model::solve_exact(
      problem,
      {.time_limit = time_limit, .start = from == ExactFrom::energy ? &scene.energy : nullptr});
  const bool exact = succeeded(scene.exact.status);
  if (exact) scene.exact_defects = defects_of(problem, scene.exact);
  if (energy && exact) {
    scene.agreement = agreement_of(problem, scene.energy, scene.exact, scene.distance);
  }
  return scene;
}

/// Returns a round rod with weight along -y as a scene file of dlo, to run it by hand. Obstacles,
/// sections, natural strains, couples, line loads and given d1 are not written.
inline std::string scene_text(const energy_model::Problem& problem, const std::string& name) {
  // A rod of 10 mm with this modulus has EI = 1 N m^2; its density makes the weight.
  constexpr double pi = std::numbers::pi;
  const double diameter = 0.01;
  const double modulus = problem.bending_stiffness * 64 / (pi * std::pow(diameter, 4));
  const double density = problem.weight_per_length.norm() / 9.81 / (pi * diameter * diameter / 4);
  std::ostringstream text;
  text.precision(17);
  const auto vector = [&](const Eigen::Vector3d& v) {
    text << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]\n";
  };
  text << "name = \"" << name << "\"\ngravity = [0, -9.81, 0]\n\n[rod]\nlength = " << problem.length
       << "\ndiameter = " << diameter << "\nmaterial = { youngs_modulus = " << modulus
       << ", density = " << density << " }\n";
  if (problem.torsional_stiffness > 0) {
    text << "torsional_stiffness = " << problem.torsional_stiffness << "\n";
  }
  for (const energy_model::Grip& grip : problem.grips) {
    text << "\n[[gripper]]\nat = " << grip.at << "\nposition = ";
    vector(grip.position);
    if (grip.direction) {
      text << "direction = ";
      vector(*grip.direction);
    }
    if (grip.frame) text << "roll = " << grip.frame->roll << "\n";
    text << "hold = \"" << (grip.direction ? "clamp" : "pin") << "\"\n";
  }
  for (const energy_model::Load& load : problem.loads) {
    text << "\n[[load]]\nat = " << load.at << "\nforce = ";
    vector(load.force);
  }
  return text.str();
}

}  // namespace dlo::test
