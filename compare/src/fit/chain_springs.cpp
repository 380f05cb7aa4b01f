#include "fit/chain_springs.hpp"

#include <Eigen/Core>
#include <algorithm>

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
  std::vector<ChainSprings> found;
  for (const bool held_in_middle : {false, true}) {
    const Eigen::VectorXd& shares = held_in_middle ? halved : whole;
    const double h = scene.length / shares.sum();
    const Shape joints = points_apart(rod, scene.length, shares);
    for (const OwnPolygon& chain : own_polygons(scene, joints, Springs::fitted)) {
      if ((chain.clamp == ChainClamp::middle) != held_in_middle) continue;
      found.push_back({.scene = scene.name,
                       .clamp = chain.clamp,
                       .segments = segments,
                       .segment_length = h,
                       .stiffness = chain.stiffness * scene.bending_stiffness() / h,
                       .over_rod = chain.stiffness,
                       .rms_m = chain.rms_m});
    }
  }
  return found;
}

}  // namespace dlo::compare
