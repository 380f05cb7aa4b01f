#include "fit/chain_springs.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "dlo/compare/reference.hpp"
#include "explain/own_polygon.hpp"

namespace dlo::compare {
namespace {

/// Points of a rod whose distances from each other have given ratios: a chain's joints.
Shape points_apart(const energy_model::Equilibrium& rod, double length,
                   const Eigen::VectorXd& shares) {
  constexpr int most_rounds = 8;
  Eigen::VectorXd parts = shares * (length / shares.sum());
  Shape shape;
  for (int round = 0; round < most_rounds; ++round) {
    shape.arc_length.assign(1, 0);
    for (const double part : parts) {
      shape.arc_length.push_back(std::min(length, shape.arc_length.back() + part));
    }
    shape.arc_length.back() = length;
    shape.points = rod.sample(shape.arc_length).points;
    const Eigen::Index n = shares.size();
    const Eigen::VectorXd chords =
        (shape.points.rightCols(n) - shape.points.leftCols(n)).colwise().norm();
    // Chords are shorter than arcs by their bow, which hardly changes.
    parts = parts.cwiseProduct(shares).cwiseQuotient(chords);
    parts *= length / parts.sum();
  }
  return shape;
}

bool has_clamp_at(const Scene& scene, double at) {
  return std::any_of(scene.grippers.begin(), scene.grippers.end(), [at](const Gripper& gripper) {
    return gripper.direction && gripper.at == at;
  });
}

}  // namespace

std::vector<ChainSprings> chain_springs(const Scene& scene, int segments,
                                        const SolveOptions& options) {
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy, options);
  const Eigen::VectorXd whole = Eigen::VectorXd::Ones(segments);
  Eigen::VectorXd halved = whole;
  if (has_clamp_at(scene, 0)) halved[0] = 0.5;
  if (has_clamp_at(scene, scene.length)) halved[segments - 1] = 0.5;
  const double second_moment = std::numbers::pi * std::pow(scene.diameter, 4) / 64;
  std::vector<ChainSprings> found;
  for (const bool held_in_middle : {false, true}) {
    const Eigen::VectorXd& shares = held_in_middle ? halved : whole;
    const double h = scene.length / shares.sum();
    const Shape joints = points_apart(rod, scene.length, shares);
    const std::vector<OwnPolygon> binormal =
        own_polygons(scene, joints, Springs::fitted, energy_model::JointLaw::binormal);
    for (const OwnPolygon& chain :
         own_polygons(scene, joints, Springs::fitted, energy_model::JointLaw::linear)) {
      if ((chain.clamp == ChainClamp::middle) != held_in_middle) continue;
      found.push_back({.scene = scene.name,
                       .clamp = chain.clamp,
                       .segments = segments,
                       .segment_length = h,
                       .stiffness = chain.stiffness * scene.bending_stiffness() / h,
                       .over_rod = chain.stiffness,
                       .rms_m = chain.rms_m,
                       .mass_per_length = scene.mass() / scene.length,
                       .diameter = scene.diameter});
      for (const OwnPolygon& other : binormal) {
        if (other.clamp != chain.clamp) continue;
        found.back().binormal_stiffness = other.stiffness * scene.bending_stiffness() / h;
      }
      if (second_moment > 0) {
        found.back().equivalent_modulus = found.back().stiffness * h / second_moment;
      }
    }
  }
  return found;
}

std::vector<SimulatorParameter> simulator_parameters(const ChainSprings& chain) {
  const double joint = chain.stiffness;
  const double h = chain.segment_length;
  std::vector<SimulatorParameter> all = {
      {"MuJoCo", "joint stiffness", "N m/rad", joint},
      {"Bullet", "btGeneric6DofSpring2Constraint::setStiffness", "N m/rad", joint},
      // 1.2.0 stopped dividing it by the length of a segment.
      {"Newton", "add_rod bend_stiffness before 1.2.0", "N m^2", joint * h},
      {"Newton", "add_rod bend_stiffness 1.2.0 to 1.4", "N m/rad", joint},
      {"Newton", "add_joint_cable bend_stiffness to 1.4", "N m/rad", joint},
      {"Drake", "RevoluteSpring stiffness", "N m/rad", joint},
      {"PhysX", "PxD6JointDrive stiffness", "N m/rad", joint},
      // USD keeps angles in degrees.
      {"Isaac Sim", "PhysicsDriveAPI:rotX stiffness", "N m/deg", joint * std::numbers::pi / 180}};
  if (chain.binormal_stiffness > 0) {
    all.push_back(
        {"Newton", "add_rod bend_stiffness since 1.5", "N m/rad", chain.binormal_stiffness});
    all.push_back({"Newton", "Rod bend_rigidity since 1.6", "N m^2", chain.binormal_stiffness * h});
  }
  if (chain.diameter > 0 && chain.mass_per_length > 0) {
    const double r = chain.diameter / 2;
    const double capsule = std::numbers::pi * r * r * (h + 4 * r / 3);
    for (const char* simulator : {"MuJoCo", "Newton"}) {
      all.push_back(
          {simulator, "density of a capsule", "kg/m^3", chain.mass_per_length * h / capsule});
    }
  }
  if (chain.equivalent_modulus > 0) {
    all.push_back({"MuJoCo", "cable plugin bend", "Pa", chain.equivalent_modulus});
    // Its first element is held whole, as that of a welded chain.
    if (chain.clamp == ChainClamp::welded) {
      all.push_back({"PyElastica", "youngs_modulus", "Pa", chain.equivalent_modulus});
    }
  }
  return all;
}

}  // namespace dlo::compare
