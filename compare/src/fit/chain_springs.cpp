#include "fit/chain_springs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/reference.hpp"
#include "explain/own_polygon.hpp"
#include "shape/curve.hpp"

namespace dlo::compare {
namespace {

/// Returns points of a rod, the joints of a chain, whose distances have given ratios.
Shape points_with_distance_ratios(const energy_model::Equilibrium& rod, double length,
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
    // Chords are shorter than their arcs, by amounts that hardly change between rounds.
    parts = parts.cwiseProduct(shares).cwiseQuotient(chord_lengths(shape.points));
    parts *= length / parts.sum();
  }
  return shape;
}

bool has_clamp_at(const Scene& scene, double at) {
  return std::any_of(scene.grippers.begin(), scene.grippers.end(), [at](const Gripper& gripper) {
    return gripper.direction && gripper.at == at;
  });
}

/// Returns the springs of a chain whose segments are these shares of the rod.
/// @param h  length of a whole segment; the mean if segments are unequal [m]
std::vector<ChainSprings> springs_of(const Scene& scene, const energy_model::Equilibrium& rod,
                                     const Eigen::VectorXd& shares, double h) {
  const Shape joints = points_with_distance_ratios(rod, scene.length, shares);
  const std::vector<CandidateChain> binormal =
      candidate_chains(scene, joints, Springs::fitted, energy_model::JointLaw::binormal);
  std::vector<ChainSprings> found;
  for (const CandidateChain& chain :
       candidate_chains(scene, joints, Springs::fitted, energy_model::JointLaw::linear)) {
    found.push_back({.scene = scene.name,
                     .clamp = chain.clamp,
                     .segments = static_cast<int>(shares.size()),
                     .segment_length = h,
                     .stiffness = chain.stiffness * scene.bending_stiffness() / h,
                     .stiffness_ratio = chain.stiffness,
                     .rms_m = chain.rms_m});
    ChainSprings& own = found.back();
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      own.joints.push_back({.at = chain.joints[i], .stiffness = chain.springs[i]});
    }
    for (const CandidateChain& other : binormal) {
      if (other.clamp != chain.clamp) continue;
      own.binormal_stiffness = other.stiffness * scene.bending_stiffness() / h;
      for (std::size_t i = 0; i < own.joints.size(); ++i) {
        own.joints[i].binormal_stiffness = other.springs[i];
      }
    }
  }
  return found;
}

/// Returns the shares of segments with given lengths.
/// @throws InputError in the cases of chain_springs()
Eigen::VectorXd segment_shares(const Scene& scene, const std::vector<double>& lengths) {
  constexpr std::size_t least_count = 4;
  constexpr std::size_t most = 200;
  if (lengths.size() < least_count || lengths.size() > most) {
    throw InputError(fmt::format("{}: a chain of {} segments (allowed: {} to {})", scene.file,
                                 lengths.size(), least_count, most));
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
        fmt::format("{}: a chain {:.6g} m long, but the rod is {:.6g} m long (allowed: equal "
                    "within {:g} %, the chain is then scaled)",
                    scene.file, sum, scene.length, 100 * tolerance));
  }
  return Eigen::Map<const Eigen::VectorXd>(lengths.data(),
                                           static_cast<Eigen::Index>(lengths.size())) /
         sum;
}

}  // namespace

std::vector<ChainSprings> chain_springs(const Scene& scene, int segments,
                                        const SolveOptions& options) {
  const energy_model::Equilibrium rod = solve_reference(scene, options);
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
  const Eigen::VectorXd shares = segment_shares(scene, lengths);
  const energy_model::Equilibrium rod = solve_reference(scene, options);
  const double mean = scene.length / static_cast<double>(lengths.size());
  std::vector<ChainSprings> found = springs_of(scene, rod, shares, mean);
  for (ChainSprings& chain : found) {
    for (const double share : shares) chain.segment_lengths.push_back(share * scene.length);
  }
  return found;
}

std::vector<double> segment_lengths(const Eigen::Matrix3Xd& points) {
  const Eigen::VectorXd lengths = chord_lengths(points);
  return {lengths.begin(), lengths.end()};
}

}  // namespace dlo::compare
