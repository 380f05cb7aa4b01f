#include "dlo/energy_model/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "base/legendre.hpp"
#include "base/require.hpp"
#include "dynamics/moving_span.hpp"
#include "problem/rod_law.hpp"
#include "search/twist_path.hpp"
#include "span/local_solver.hpp"
#include "vibration/span_modes.hpp"

namespace dlo::energy_model {
namespace {

constexpr const char* simulate_name = "simulate";

/// Returns the rod with a motion for each grip, with the problem at the begin, and with cuts at
/// point masses.
MovingRod with_all_motions(MovingRod rod, double begin) {
  const Problem given = rod.problem;
  Problem& problem = rod.problem;
  rod.motions.resize(problem.grips.size());
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    Grip& grip = problem.grips[i];
    if (!rod.motions[i]) rod.motions[i] = fixed_grip(grip.position);
    const GripPose pose = rod.motions[i](begin);
    grip.position = pose.position;
    const Eigen::Quaterniond turn = pose.turn.normalized();
    if (turn.isApprox(Eigen::Quaterniond::Identity())) continue;
    if (grip.frame) grip.frame->d1 = turn * held_d1(given, given.grips[i]);
    if (grip.direction) grip.direction = (turn * *grip.direction).eval();
  }
  for (const PointMass& mass : rod.inertia.point_masses) problem.loads.push_back({mass.at});
  return rod;
}

void check_rod(const MovingRod& rod) {
  check(rod.problem);
  check(rod.problem, rod.inertia, simulate_name);
  require(rod.motions.size() <= rod.problem.grips.size(), simulate_name, "motions.size()",
          static_cast<double>(rod.motions.size()), "<= the number of grips");
  require_not_negative(simulate_name, "material_damping", rod.material_damping);
  require_not_negative(simulate_name, "air_drag", rod.air_drag);
  require_not_negative(simulate_name, "quadratic_drag", rod.quadratic_drag);
  for (const double time : rod.breaks) {
    require_finite(simulate_name, "breaks", time);
  }
  require(rod.obstacle_motions.size() <= rod.problem.obstacles.size(), simulate_name,
          "obstacle_motions.size()", static_cast<double>(rod.obstacle_motions.size()),
          "<= the number of obstacles");
}

/// Prescribes the frame at the end of a span between clamps with frames. A rod without material
/// directors gets them, so that strains of twist are among the unknowns.
void prescribe_end_frame(const Problem& problem, PlacedSpan& placed) {
  if (!placed.frames) return;
  Span& span = placed.span;
  span.planar = false;
  if (!span.has_material_directors()) {
    span.natural.coefficients = {Eigen::Vector3d::Zero()};
    span.stiffness[2] = problem.torsional_stiffness / bending_unit(problem);
    span.principal_d1 = placed.frames->start_d1;
  }
  span.twist = Span::Twist{placed.frames->stiffness, prescribed_end_d1(*placed.frames, span)};
}

void check_options(std::span<const double> times, const DynamicsOptions& options) {
  require(options.terms > 0 && options.terms <= max_terms, simulate_name, "terms", options.terms,
          "1 to 128");
  require_positive(simulate_name, "tolerance", options.tolerance);
  require_not_negative(simulate_name, "step", options.step);
  require_positive(simulate_name, "contact_depth", options.contact_depth);
  require(options.time_limit > 0, simulate_name, "time_limit", options.time_limit, "> 0");
  for (std::size_t i = 0; i < times.size(); ++i) {
    require_finite(simulate_name, "times", times[i]);
    require(i == 0 || times[i] > times[i - 1], simulate_name, "times", times[i],
            "strictly increasing");
  }
}

/// Returns the point masses of each span; one at a clamp between two spans belongs to the first of
/// them.
std::vector<std::vector<PointMass>> masses_by_span(const MovingRod& rod,
                                                   const std::vector<PlacedSpan>& spans) {
  std::vector<std::vector<PointMass>> result(spans.size());
  for (const PointMass& mass : rod.inertia.point_masses) {
    for (std::size_t i = 0; i < spans.size(); ++i) {
      const double s = spans[i].s_of(mass.at, rod.problem.length);
      if (s < -same_arc_length_share || s > spans[i].span.length + same_arc_length_share) continue;
      result[i].push_back(mass);
      break;
    }
  }
  return result;
}

/// Combines the spans' results at one of the times that all have reached.
MovingFrame combine_frames(const MovingRod& rod, const std::vector<SpanRun>& runs, std::size_t k) {
  MovingFrame frame;
  frame.grips.resize(rod.problem.grips.size());
  frame.obstacles.assign(rod.problem.obstacles.size(), Eigen::Vector3d::Zero());
  auto shapes = std::make_shared<std::vector<PlacedShape>>();
  for (const SpanRun& run : runs) {
    const SpanFrame& of = run.frames[k];
    add(of.energy, 1, frame.energy);
    for (const auto& [grip, reaction] : of.grips) {
      frame.grips[grip].force += reaction.force;
      frame.grips[grip].torque += reaction.torque;
    }
    for (const auto& [obstacle, force] : of.obstacles) frame.obstacles[obstacle] += force;
    shapes->push_back(of.shape);
  }
  frame.sample = [shapes, l = rod.problem.length](std::span<const double> arc_lengths) {
    return energy_model::sample(*shapes, l, arc_lengths);
  };
  return frame;
}

/// Changes the zero of gravity and load energies from the spans' own anchors to the first anchor.
void shift_energy_zero(const MovingRod& rod, const std::vector<PlacedSpan>& spans,
                       EnergyBalance& energy) {
  const double l = rod.problem.length;
  const double force = bending_unit(rod.problem) / (l * l);
  for (const PlacedSpan& placed : spans) {
    const Eigen::Vector3d offset =
        placed.frame * (placed.anchor_position - spans.front().anchor_position);
    energy.gravity -= force * offset.dot(placed.span.weight_between(0, placed.span.length));
    for (const Span::Load& load : placed.span.loads) energy.load -= force * offset.dot(load.force);
  }
}

/// Adds the loads on clamps to the reactions and the work of these clamps, which alone carry them.
void add_loads_on_clamps(const MovingRod& rod, double begin, MovingFrame& frame) {
  for (const Load& load : rod.problem.loads) {
    const std::optional<std::size_t> clamp = clamp_at_load(rod.problem, load);
    if (!clamp) continue;
    const Eigen::Vector3d moved =
        rod.motions[*clamp](frame.time).position - rod.motions[*clamp](begin).position;
    frame.grips[*clamp].force -= load.force;
    frame.energy.load -= load.force.dot(moved);
    frame.energy.work -= load.force.dot(moved);
  }
}

/// Returns the largest of the parts of an energy balance; potentials count from their values in the
/// first frame.
double largest_part(const EnergyBalance& energy, const EnergyBalance& first) {
  return std::max({energy.kinetic, energy.bending, energy.twisting, energy.obstacles,
                   energy.dissipated, energy.lost, std::abs(energy.work),
                   std::abs(energy.gravity - first.gravity), std::abs(energy.load - first.load)});
}

/// Adds the rod's frames at the times that all spans have reached. The first frame, at the begin,
/// is used only for the energy balance.
void add_frames(const MovingRod& rod, const std::vector<PlacedSpan>& spans,
                const std::vector<SpanRun>& runs, std::span<const double> times, Dynamics& result) {
  const double begin = times.empty() ? 0 : std::min(0.0, times.front());
  std::size_t reached = times.size() + 1;
  for (const SpanRun& run : runs) reached = std::min(reached, run.frames.size());
  EnergyBalance first;
  double largest_imbalance = 0;
  for (std::size_t k = 0; k < reached; ++k) {
    MovingFrame frame = combine_frames(rod, runs, k);
    frame.time = k == 0 ? begin : times[k - 1];
    shift_energy_zero(rod, spans, frame.energy);
    add_loads_on_clamps(rod, begin, frame);
    if (k == 0) first = frame.energy;
    const EnergyBalance& energy = frame.energy;
    largest_imbalance = std::max(
        largest_imbalance,
        std::abs(energy.total() - first.total() + energy.dissipated + energy.lost - energy.work));
    result.largest_energy = std::max(result.largest_energy, largest_part(energy, first));
    if (k > 0) result.frames.push_back(std::move(frame));
  }
  result.energy_error = result.largest_energy > 0 ? largest_imbalance / result.largest_energy : 0;
}

}  // namespace

StartingShape straight_rod(const Eigen::Vector3d& direction) {
  require_positive("straight_rod", "direction's length", direction.norm());
  return [unit = direction.normalized().eval()](std::span<const double> arc_lengths) {
    Samples samples;
    samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
    const Eigen::Map<const Eigen::RowVectorXd> s(arc_lengths.data(), std::ssize(arc_lengths));
    samples.points = unit * s;
    samples.tangents = unit.replicate(1, s.size());
    samples.curvature = Eigen::Matrix3Xd::Zero(3, s.size());
    return samples;
  };
}

Dynamics simulate(const MovingRod& rod, const StartingShape& start, std::span<const double> times,
                  const DynamicsOptions& options) {
  check_rod(rod);
  check_options(times, options);
  const Deadline deadline(options.time_limit);
  const double begin = times.empty() ? 0 : std::min(0.0, times.front());
  const MovingRod complete = with_all_motions(rod, begin);
  require(!has_couples(complete.problem), simulate_name, "torque of a load", 1,
          "0: simulate() does not support couples");
  require(!complete.problem.confined_to_plane, simulate_name, "confined_to_plane", 1,
          "false: only solve_energy() confines a rod to a plane");
  std::vector<PlacedSpan> spans = split(complete.problem);
  for (PlacedSpan& placed : spans) {
    prescribe_end_frame(complete.problem, placed);
    require_affordable(placed.span, options.terms, simulate_name);
  }
  const std::vector<std::vector<PointMass>> masses = masses_by_span(complete, spans);

  Dynamics result;
  result.terms = options.terms;
  result.status = SolveStatus::converged;
  result.message = to_string(result.status);
  result.error_estimate = 0;
  std::vector<SpanRun> runs;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    PlacedSpan placed = spans[i];
    placed.span.planar = placed.span.planar && !options.spatial;
    const auto run_placed = [&] {
      return run_span(complete, placed, {begin, start, masses[i], times}, options, deadline);
    };
    SpanRun run = run_placed();
    if (run.left_plane) {
      placed.span.planar = false;
      run = run_placed();
    }
    result.steps += run.steps;
    result.smallest_step = std::min(result.smallest_step, run.smallest_step);
    result.error_estimate += run.error;
    result.deepest_contact = std::max(result.deepest_contact, run.depth);
    if (run.status != SolveStatus::converged) {
      result.status = run.status;
      result.message = run.message;
    }
    runs.push_back(std::move(run));
  }
  if (options.step > 0) result.error_estimate = std::numeric_limits<double>::quiet_NaN();
  add_frames(complete, spans, runs, times, result);
  return result;
}

}  // namespace dlo::energy_model
