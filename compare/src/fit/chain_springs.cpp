#include "fit/chain_springs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "dlo/compare/error.hpp"
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

/// The springs of a chain whose segments are these shares of the rod.
/// @param h  the length of a whole segment, of unequal ones the mean [m]
std::vector<ChainSprings> springs_of(const Scene& scene, const energy_model::Equilibrium& rod,
                                     const Eigen::VectorXd& shares, double h) {
  const double second_moment = std::numbers::pi * std::pow(scene.diameter, 4) / 64;
  const Shape joints = points_apart(rod, scene.length, shares);
  const std::vector<OwnPolygon> binormal =
      own_polygons(scene, joints, Springs::fitted, energy_model::JointLaw::binormal);
  std::vector<ChainSprings> found;
  for (const OwnPolygon& chain :
       own_polygons(scene, joints, Springs::fitted, energy_model::JointLaw::linear)) {
    found.push_back({.scene = scene.name,
                     .clamp = chain.clamp,
                     .segments = static_cast<int>(shares.size()),
                     .segment_length = h,
                     .stiffness = chain.stiffness * scene.bending_stiffness() / h,
                     .over_rod = chain.stiffness,
                     .rms_m = chain.rms_m,
                     .mass_per_length = scene.mass() / scene.length,
                     .diameter = scene.diameter});
    ChainSprings& own = found.back();
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      own.joints.push_back({.at = chain.joints[i], .stiffness = chain.springs[i]});
    }
    for (const OwnPolygon& other : binormal) {
      if (other.clamp != chain.clamp) continue;
      own.binormal_stiffness = other.stiffness * scene.bending_stiffness() / h;
      for (std::size_t i = 0; i < own.joints.size(); ++i) {
        own.joints[i].binormal_stiffness = other.springs[i];
      }
    }
    if (second_moment > 0) own.equivalent_modulus = own.stiffness * h / second_moment;
  }
  return found;
}

/// @throws InputError as chain_springs()
Eigen::VectorXd shares_of(const Scene& scene, const std::vector<double>& lengths) {
  constexpr std::size_t fewest = 4;
  constexpr std::size_t most = 200;
  if (lengths.size() < fewest || lengths.size() > most) {
    throw InputError(fmt::format("{}: a chain of {} segments (allowed: {} to {})", scene.file,
                                 lengths.size(), fewest, most));
  }
  double sum = 0;
  for (const double part : lengths) {
    if (!(part > 0)) {
      throw InputError(fmt::format("{}: a segment of {:g} m (allowed: > 0)", scene.file, part));
    }
    sum += part;
  }
  constexpr double tolerance = 0.05;
  if (!(std::abs(sum / scene.length - 1) <= tolerance)) {
    throw InputError(
        fmt::format("{}: a chain {:.6g} m long, the rod is {:.6g} m long (allowed: the same within "
                    "{:g} %, which is scaled away)",
                    scene.file, sum, scene.length, 100 * tolerance));
  }
  return Eigen::Map<const Eigen::VectorXd>(lengths.data(),
                                           static_cast<Eigen::Index>(lengths.size())) /
         sum;
}

}  // namespace

std::vector<ChainSprings> chain_springs(const Scene& scene, int segments,
                                        const SolveOptions& options) {
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy, options);
  const Eigen::VectorXd whole = Eigen::VectorXd::Ones(segments);
  Eigen::VectorXd halved = whole;
  if (has_clamp_at(scene, 0)) halved[0] = 0.5;
  if (has_clamp_at(scene, scene.length)) halved[segments - 1] = 0.5;
  std::vector<ChainSprings> found;
  for (const bool held_in_middle : {false, true}) {
    const Eigen::VectorXd& shares = held_in_middle ? halved : whole;
    for (ChainSprings& chain : springs_of(scene, rod, shares, scene.length / shares.sum())) {
      if ((chain.clamp == ChainClamp::middle) != held_in_middle) continue;
      chain.joints.clear();
      found.push_back(std::move(chain));
    }
  }
  return found;
}

std::vector<ChainSprings> chain_springs(const Scene& scene, const std::vector<double>& lengths,
                                        const SolveOptions& options) {
  const Eigen::VectorXd shares = shares_of(scene, lengths);
  const energy_model::Equilibrium rod = solve_reference(scene, Model::energy, options);
  const double mean = scene.length / static_cast<double>(lengths.size());
  std::vector<ChainSprings> found = springs_of(scene, rod, shares, mean);
  for (ChainSprings& chain : found) {
    for (const double share : shares) chain.segment_lengths.push_back(share * scene.length);
  }
  return found;
}

std::vector<double> segment_lengths(const Eigen::Matrix3Xd& points) {
  std::vector<double> lengths;
  for (Eigen::Index i = 1; i < points.cols(); ++i) {
    lengths.push_back((points.col(i) - points.col(i - 1)).norm());
  }
  return lengths;
}

std::vector<SimulatorParameter> simulator_parameters(const ChainSprings& chain) {
  if (!chain.joints.empty()) return {};
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
