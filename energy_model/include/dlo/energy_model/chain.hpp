#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "dlo/energy_model/status.hpp"

namespace dlo::energy_model {

/// The potential of a joint that bends by alpha; L is the mean length of its two segments.
enum class JointLaw {
  paper,   ///< c_b L (8/3 - 4 cos(alpha/2) + 4/3 cos^3(alpha/2))
  hooke,   ///< -4 (EI/L) ln cos(alpha/2), up to 3 rad and with constant moment beyond
  linear,  ///< EI/L alpha^2 / 2: springs in the angle, as most simulators' joints have them
  /// EI/L (2 tan(alpha/2))^2 / 2, beyond 3 rad as hooke: discrete elastic rods (Bergou et al.,
  /// SIGGRAPH 2008), whose curvature binormal is 2 tan(alpha/2) long.
  binormal,
};

/// A polygon of rigid segments in a plane, its first segment held. It is the force model's rod
/// without stretch, so its minimum is where the force model comes to rest.
struct ChainProblem {
  Eigen::VectorXd segment_lengths;                  ///< [m], n >= 2, each > 0
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< first point [m]
  double held_angle = 0;                            ///< of the first segment, from +x [rad]
  Eigen::Matrix2Xd node_forces;                     ///< dead force on each point [N], 2 x (n+1)
  JointLaw law = JointLaw::hooke;                   ///< of every joint
  double stiffness = 0;                             ///< c_b [N] or EI [N m^2], > 0
  /// Of each joint [N] or [N m^2], n-1, each > 0; empty: all have `stiffness`.
  Eigen::VectorXd stiffnesses = {};
  /// Turn of each joint at rest, counter-clockwise [rad], n-1, |alpha_0| < 3, not of law paper: its
  /// potential is P(alpha) - P(alpha_0) - P'(alpha_0) (alpha - alpha_0). Empty: straight.
  Eigen::VectorXd natural_turns = {};
};

/// Where and how far to minimise.
struct ChainOptions {
  /// Angles of the segments to start from [rad], n; empty: from the moments of the straight chain.
  Eigen::VectorXd start_angles;
  /// Of the gradient's norm, over the sum of all forces' sizes times the length and the largest
  /// moment of a joint's natural turn; > 0. Rounding may end it above that.
  double tolerance = 1e-12;
  int max_evaluations = 20000;  ///< of the energy, >= 1; beyond, `evaluation_limit`
  /// Of the whole call [s], > 0; the status is then `time_limit`.
  double time_limit = std::numeric_limits<double>::infinity();
};

/// A shape of a chain, and how it was found.
struct [[nodiscard]] ChainResult {
  /// How it ended. `saddle`: unstable in the plane or out of it. With natural turns only stability
  /// in the plane is judged.
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";  ///< the same in words
  int evaluations = 0;                ///< of energy and gradient, by both methods
  double seconds = 0;                 ///< wall time [s]
  /// Norm of the gradient by the segment angles [N m]; -1: Newton's method did not begin.
  double residual = -1;
  /// Torque about `start` of what holds the first segment, from the moment of the first joint and
  /// the force beyond it [N m].
  double held_torque = 0;
  Eigen::VectorXd angles;     ///< of the segments, from +x [rad], n
  Eigen::Matrix2Xd points;    ///< [m], 2 x (n+1)
  double bending_energy = 0;  ///< [J]; zero where every joint is at rest
  double load_energy = 0;     ///< of all forces, zero with every point at `start` [J]
};

/// Minimises the joint potentials minus the work of the forces with NLopt's LD_LBFGS over the joint
/// angles; Newton steps over the segment angles (a tridiagonal matrix) finish and prove the
/// minimum.
/// @throws std::invalid_argument if the problem or an option is out of range
ChainResult solve_chain(const ChainProblem& problem, const ChainOptions& options = {});

/// Energy [J] of a chain with these segment angles, and its gradient [N m]; the held segment's
/// component is zero.
[[nodiscard]] double chain_energy(const ChainProblem& problem,
                                  const Eigen::Ref<const Eigen::VectorXd>& angles,
                                  Eigen::Ref<Eigen::VectorXd> gradient);

}  // namespace dlo::energy_model
