#include "solve/chain_start.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "dlo/compare/chain.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/energy_model/energy.hpp"
#include "polygon/energy_problems.hpp"

namespace dlo::compare {
namespace {

/// Fine enough for a shape that only has to be near, quick enough to be no part of the cost.
constexpr int start_points = 64;

/// Directions of segments [-], 3 x (M - 1), at their middles [m].
struct Directions {
  std::vector<double> middle;
  Eigen::Matrix3Xd direction;
};

Directions directions_of(const Shape& shape) {
  const std::vector<double>& s = shape.arc_length;
  const Eigen::Index segments = shape.points.cols() - 1;
  Directions result;
  result.direction =
      (shape.points.rightCols(segments) - shape.points.leftCols(segments)).colwise().normalized();
  for (std::size_t i = 0; i + 1 < s.size(); ++i) result.middle.push_back((s[i] + s[i + 1]) / 2);
  // A gripper holds the middle of the whole segment.
  if (shape.half_at_start) result.middle.front() = s.front();
  if (shape.half_at_end) result.middle.back() = s.back();
  return result;
}

/// The chain's rest shape as a rod: its tangent turns evenly from one segment's middle to the next.
/// Without twist, which the energy model puts in from there by the scene's own rolls.
energy_model::Equilibrium chain_start(const Scene& scene, const SolveOptions& options) {
  ForceModelSettings settings = scene.force_model;
  settings.law = BendingLaw::hooke;
  settings.bookkeeping = Bookkeeping::consistent;
  settings.points = start_points;
  const Shape shape = solve_chain(scene.without_twist(), settings, options).shape;
  energy_model::Equilibrium start;
  start.message = "the chain's rest shape";
  start.sample = [shape, directions = directions_of(shape)](std::span<const double> arc_lengths) {
    const std::vector<double> s(arc_lengths.begin(), arc_lengths.end());
    energy_model::Samples samples;
    samples.points = resample(shape, s).points;
    samples.tangents =
        resample({directions.middle, directions.direction}, s).points.colwise().normalized();
    samples.curvature = Eigen::Matrix3Xd::Zero(3, samples.points.cols());
    return samples;
  };
  return start;
}

}  // namespace

energy_model::Equilibrium solve_from_chain(const Scene& scene, const SolveOptions& options) {
  // Enough for what converges; what does not should say so soon.
  constexpr int most_evaluations = 6000;
  const energy_model::Equilibrium start = chain_start(scene, options);
  return energy_model::solve_energy(
      energy_problem(scene),
      {.terms = options.terms,
       .max_evaluations = std::min(options.max_evaluations, most_evaluations),
       .time_limit = options.time_limit,
       .start = &start});
}

}  // namespace dlo::compare
