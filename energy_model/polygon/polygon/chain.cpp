#include "dlo/energy_model/chain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/deadline.hpp"
#include "base/require.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the joint between segments i-1 and i at the angle alpha, including its stress-free
/// angle.
AngleJoint joint_at(const ChainProblem& problem, Eigen::Index i, double alpha) {
  const double stiffness = joint_stiffness(problem, i);
  const double L = joint_length(problem.segment_lengths, i);
  AngleJoint joint = joint_by_angle(problem.law, stiffness, L, alpha);
  if (problem.natural_turns.size() == 0) return joint;
  const double natural = problem.natural_turns[i - 1];
  const AngleJoint free = joint_by_angle(problem.law, stiffness, L, natural);
  joint.energy -= free.energy + free.moment * (alpha - natural);
  joint.moment -= free.moment;
  return joint;
}

/// Returns the force in each segment: the sum of the node forces beyond it.
Eigen::Matrix2Xd segment_forces(const ChainProblem& problem) {
  const Eigen::Index n = problem.segment_lengths.size();
  Eigen::Matrix2Xd forces(2, n);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    sum += problem.node_forces.col(j + 1);
    forces.col(j) = sum;
  }
  return forces;
}

void check(const ChainProblem& problem, const ChainOptions& options) {
  const Eigen::Index n = problem.segment_lengths.size();
  require(n >= 2, "ChainProblem", "number of segments", static_cast<double>(n), ">= 2");
  require(problem.segment_lengths.minCoeff() > 0 && problem.segment_lengths.allFinite(),
          "ChainProblem", "smallest segment length", problem.segment_lengths.minCoeff(),
          "finite and > 0");
  require(problem.node_forces.cols() == n + 1, "ChainProblem", "columns of node_forces",
          static_cast<double>(problem.node_forces.cols()), "one more than segments");
  require(problem.node_forces.allFinite() && problem.start.allFinite(), "ChainProblem",
          "node_forces", problem.node_forces.norm(), "finite");
  require_finite("ChainProblem", "first_angle", problem.first_angle);
  require_positive("ChainProblem", "stiffness", problem.stiffness);
  require_unlike_joints("ChainProblem", problem.law, problem.stiffnesses, problem.natural_turns, n);
  require_positive("ChainOptions", "tolerance", options.tolerance);
  require(options.max_evaluations >= 1, "ChainOptions", "max_evaluations", options.max_evaluations,
          ">= 1");
  require(options.time_limit > 0, "ChainOptions", "time_limit", options.time_limit, "> 0");
  require(options.start_angles.size() == 0 || options.start_angles.size() == n, "ChainOptions",
          "size of start_angles", static_cast<double>(options.start_angles.size()),
          "0 or the number of segments");
  require_finite("ChainOptions", "start_angles", options.start_angles);
}

/// Returns initial angles: each joint is bent as its law would bend it under the moments of the
/// straight chain. The sum of the bends is limited to the angle between the held segment and the
/// total force.
Eigen::VectorXd start_from_moments(const ChainProblem& problem) {
  const Eigen::Index n = problem.segment_lengths.size();
  const Eigen::Matrix2Xd forces = segment_forces(problem);
  const Eigen::Vector2d normal(-std::sin(problem.first_angle), std::cos(problem.first_angle));
  const Eigen::Vector2d tangent(std::cos(problem.first_angle), std::sin(problem.first_angle));
  Eigen::VectorXd turns = Eigen::VectorXd::Zero(n);
  double moment = 0;
  for (Eigen::Index i = n - 1; i >= 1; --i) {
    moment += forces.col(i).dot(normal) * problem.segment_lengths[i];
    const double L = joint_length(problem.segment_lengths, i);
    const double stiffness = joint_stiffness(problem, i);
    const double size = problem.law == JointLaw::paper
                            ? std::cbrt(4 * std::abs(moment) / (stiffness * L))
                            : std::abs(moment) * L / stiffness;
    turns[i] = std::copysign(std::min(size, 1.0), moment);
  }
  const Eigen::Vector2d total = forces.col(0);
  const double limit = std::abs(std::atan2(total.dot(normal), total.dot(tangent)));
  const double turned = std::abs(turns.sum());
  if (turned > limit) turns *= limit / turned;
  // An upright chain has no moment at all; a small rotation lets it find its buckled shape.
  if (turned < 1e-6 && total.dot(tangent) < 0) turns[1] = 1e-3;
  if (problem.natural_turns.size() > 0) turns.tail(n - 1) += problem.natural_turns;
  turns[0] += problem.first_angle;
  std::partial_sum(turns.begin(), turns.end(), turns.begin());
  return turns;
}

/// Directions in which the angles of a chain move.
enum class BendingDirection { in_plane, out_of_plane };

/// Returns the second derivative by the angles of the free segments 1 .. n-1, as a band (see
/// PolygonFactor). Out of the plane it is that of a chain without natural turns. With the angles
/// psi, and the angle alpha of the joint between segments j = i - 1 and i of the planar chain,
///     cos(alpha') = cos(psi_j) cos(psi_i) cos(alpha) + sin(psi_j) sin(psi_i)
/// so that with the moment M = P'(alpha) and the force F in the segment of length L
///     2 E = sum M / sin(alpha) (cos(alpha) (psi_j^2 + psi_i^2) - 2 psi_j psi_i) + sum L F.t
///     psi_i^2
Eigen::MatrixXd second_derivative(const ChainProblem& problem, const Eigen::Matrix2Xd& forces,
                                  const Eigen::VectorXd& angles, BendingDirection bends) {
  const Eigen::Index free = angles.size() - 1;
  Eigen::MatrixXd band = Eigen::MatrixXd::Zero(std::min<Eigen::Index>(2, free), free);
  for (Eigen::Index i = 1; i <= free; ++i) {
    const double alpha = angles[i] - angles[i - 1];
    const AngleJoint joint = joint_at(problem, i, alpha);
    double coupled = joint.stiffness;
    double own = coupled;
    if (bends == BendingDirection::out_of_plane) {
      const double sine = std::sin(alpha);
      if (sine != 0) coupled = joint.moment / sine;
      own = coupled * std::cos(alpha);
    }
    const Eigen::Vector2d tangent(std::cos(angles[i]), std::sin(angles[i]));
    band(0, i - 1) += own + problem.segment_lengths[i] * forces.col(i).dot(tangent);
    if (i == 1) continue;
    band(0, i - 2) += own;
    band(1, i - 2) -= coupled;
  }
  return band;
}

Eigen::Matrix2Xd chain_points(const ChainProblem& problem, const Eigen::VectorXd& angles) {
  Eigen::Matrix2Xd points(2, angles.size() + 1);
  points.col(0) = problem.start;
  for (Eigen::Index i = 0; i < angles.size(); ++i) {
    points.col(i + 1) =
        points.col(i) +
        problem.segment_lengths[i] * Eigen::Vector2d(std::cos(angles[i]), std::sin(angles[i]));
  }
  return points;
}

/// Returns the largest moment of a straight joint that is bent in its stress-free shape [N m].
double largest_natural_moment(const ChainProblem& problem) {
  double largest = 0;
  for (Eigen::Index i = 1; i <= problem.natural_turns.size(); ++i) {
    largest = std::max(largest, std::abs(joint_at(problem, i, 0).moment));
  }
  return largest;
}

/// Takes damped Newton steps until the gradient is below the tolerance. No step may increase the
/// energy beyond rounding or double the gradient.
void minimise_by_newton(const ChainProblem& problem, const ChainOptions& options,
                        const Deadline& deadline, double moment_scale, ChainResult& result) {
  const Eigen::Matrix2Xd forces = segment_forces(problem);
  const Eigen::Index free = result.angles.size() - 1;
  Eigen::VectorXd gradient(result.angles.size());
  double energy = chain_energy(problem, result.angles, gradient);
  ++result.evaluations;
  // Angles near pi have a rounding error that stiff joints turn into moments.
  const double rounding_moment =
      4 * std::numeric_limits<double>::epsilon() * std::numbers::pi *
      std::sqrt(static_cast<double>(free)) *
      second_derivative(problem, forces, result.angles, BendingDirection::in_plane)
          .row(0)
          .cwiseAbs()
          .maxCoeff();
  const double tolerance =
      std::max(options.tolerance * moment_scale, std::min(rounding_moment, 1e-6 * moment_scale));
  PolygonFactor factor;
  const Eigen::MatrixXd none(free, 0);
  double damping = 0;
  while (result.evaluations < options.max_evaluations) {
    if (deadline.passed()) {
      result.status = SolveStatus::time_limit;
      return;
    }
    result.residual = gradient.norm();
    const Eigen::MatrixXd band =
        second_derivative(problem, forces, result.angles, BendingDirection::in_plane);
    const bool small = result.residual <= tolerance;
    const bool positive = factor.compute(band, none, damping * band.row(0).cwiseAbs().maxCoeff());
    if (small && damping == 0) {
      const bool stays_in_plane = problem.natural_turns.size() > 0 ||
                                  factor.compute(second_derivative(problem, forces, result.angles,
                                                                   BendingDirection::out_of_plane),
                                                 none, 0);
      result.status = positive && stays_in_plane ? SolveStatus::converged : SolveStatus::saddle;
      return;
    }
    if (small) {
      damping = 0;
      continue;
    }
    if (!positive) {
      if (damping > 1e6) break;
      damping = std::max(4 * damping, 1e-8);
      continue;
    }
    Eigen::VectorXd trial = result.angles;
    trial.tail(free) -= factor.solve(gradient.tail(free));
    Eigen::VectorXd trial_gradient(gradient.size());
    const double trial_energy = chain_energy(problem, trial, trial_gradient);
    ++result.evaluations;
    const double rounding = 1e-14 * (std::abs(energy) + moment_scale);
    if (trial_energy < energy + rounding && trial_gradient.norm() < 2 * result.residual) {
      result.angles = trial;
      gradient = trial_gradient;
      energy = trial_energy;
      damping = damping < 1e-7 ? 0 : damping / 8;
    } else {
      if (damping > 1e6) break;
      damping = std::max(4 * damping, 1e-8);
    }
  }
  result.status = result.evaluations >= options.max_evaluations ? SolveStatus::evaluation_limit
                                                                : SolveStatus::failed;
}

}  // namespace

double chain_energy(const ChainProblem& problem, const Eigen::Ref<const Eigen::VectorXd>& angles,
                    Eigen::Ref<Eigen::VectorXd> gradient) {
  const Eigen::Index n = angles.size();
  gradient.setZero();
  double energy = 0;
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    force += problem.node_forces.col(i + 1);
    const double L = problem.segment_lengths[i];
    const double c = std::cos(angles[i]);
    const double s = std::sin(angles[i]);
    energy -= L * (force.x() * c + force.y() * s);
    if (i == 0) break;
    gradient[i] += L * (force.x() * s - force.y() * c);
    const AngleJoint j = joint_at(problem, i, angles[i] - angles[i - 1]);
    energy += j.energy;
    gradient[i] += j.moment;
    gradient[i - 1] -= j.moment;
  }
  gradient[0] = 0;
  return energy;
}

ChainResult solve_chain(const ChainProblem& problem, const ChainOptions& options) {
  const Deadline deadline(options.time_limit);
  check(problem, options);
  const Eigen::Index n = problem.segment_lengths.size();
  ChainResult result;
  result.angles =
      options.start_angles.size() > 0 ? options.start_angles : start_from_moments(problem);
  result.angles[0] = problem.first_angle;

  const double moment_scale =
      problem.node_forces.colwise().norm().sum() * problem.segment_lengths.sum() +
      // Not zero without forces: the straight chain then converges at once.
      largest_natural_moment(problem) + 1e-300;
  minimise_by_newton(problem, options, deadline, moment_scale, result);
  result.message = to_string(result.status);

  result.points = chain_points(problem, result.angles);
  for (Eigen::Index i = 1; i < n; ++i) {
    result.bending_energy += joint_at(problem, i, result.angles[i] - result.angles[i - 1]).energy;
  }
  const Eigen::Vector2d across(-std::sin(result.angles[0]), std::cos(result.angles[0]));
  result.clamp_torque = -joint_at(problem, 1, result.angles[1] - result.angles[0]).moment -
                        problem.segment_lengths[0] * across.dot(segment_forces(problem).col(0));
  result.seconds = deadline.spent();
  return result;
}

}  // namespace dlo::energy_model
