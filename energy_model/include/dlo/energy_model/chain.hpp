#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "dlo/energy_model/status.hpp"

namespace dlo::energy_model {

/// Potential of a joint that bends by alpha; L is the mean length of its two segments.
enum class JointLaw {
  paper,   ///< c_b L (8/3 - 4 cos(alpha/2) + 4/3 cos^3(alpha/2))
  hooke,   ///< -4 (EI/L) ln cos(alpha/2) up to 3 rad; the moment is constant beyond
  linear,  ///< EI/L alpha^2 / 2: a spring in the angle, as in the joints of most simulators
  /// EI/L (2 tan(alpha/2))^2 / 2, beyond 3 rad continued as in `hooke`: discrete elastic rods
  /// (Bergou et al., SIGGRAPH 2008), whose curvature binormal has the length 2 tan(alpha/2).
  binormal,
};

/// A polygon of rigid segments in a plane whose first segment is clamped. It is the force model's
/// rod without stretch, so its energy minimum is the shape at which the force model comes to rest.
struct ChainProblem {
  Eigen::VectorXd segment_lengths;  ///< lengths of the n segments [m], n >= 2, each > 0
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  ///< first point [m]
  double first_angle = 0;                           ///< angle of the first segment from +x [rad]
  Eigen::Matrix2Xd node_forces;                     ///< dead force on each point [N], 2 x (n+1)
  JointLaw law = JointLaw::hooke;                   ///< law of every joint
  double stiffness = 0;  ///< bending stiffness: c_b [N] for law paper, else EI [N m^2]; > 0
  /// Bending stiffness of each joint [N] or [N m^2], n-1 values, each > 0; empty: all joints have
  /// `stiffness`.
  Eigen::VectorXd stiffnesses = {};
  /// Stress-free bending angle alpha_0 of each joint, counter-clockwise [rad], n-1 values,
  /// |alpha_0| < 3. Its potential is P(alpha) - P(alpha_0) - P'(alpha_0) (alpha - alpha_0). Law
  /// paper does not allow it. Empty: straight.
  Eigen::VectorXd natural_turns = {};
};

/// Initial guess and limits of a minimisation.
struct ChainOptions {
  /// Initial angles of the segments [rad], n values, of which first_angle replaces the first;
  /// empty: computed from the moments of the straight chain.
  Eigen::VectorXd start_angles;
  /// Norm of the gradient at which the minimisation ends, divided by the sum of the sizes of all
  /// forces times the length, plus the largest moment of a joint's stress-free angle; > 0. Rounding
  /// may end the minimisation at a larger gradient.
  double tolerance = 1e-12;
  /// Maximum number of energy evaluations, >= 1. A call that reaches it returns `evaluation_limit`.
  int max_evaluations = 20000;
  /// Time limit of the whole call [s], > 0. A call that reaches it returns `time_limit`.
  double time_limit = std::numeric_limits<double>::infinity();
};

/// Shape of a chain and outcome of its minimisation.
struct [[nodiscard]] ChainResult {
  /// Outcome. `saddle`: unstable in the plane or out of it. With natural turns stability is judged
  /// in the plane only.
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";  ///< the status in words
  int evaluations = 0;                ///< evaluations of energy and gradient
  double seconds = 0;                 ///< wall time [s]
  /// Norm of the gradient with respect to the segment angles [N m]; not meaningful if a limit was
  /// reached.
  double residual = -1;
  /// Torque about `start` that the clamp of the first segment exerts, computed from the moment of
  /// the first joint and the force beyond it [N m].
  double clamp_torque = 0;
  Eigen::VectorXd angles;   ///< angles of the segments from +x [rad], n values
  Eigen::Matrix2Xd points;  ///< [m], 2 x (n+1)
  /// Energy of all joints [J]; zero if every joint has its stress-free angle.
  double bending_energy = 0;
};

/// Minimises the joint potentials minus the work of the forces by damped Newton steps over the
/// segment angles (a tridiagonal matrix). No step increases the energy beyond rounding. The Hessian
/// at the end proves the minimum.
/// @throws std::invalid_argument if the problem or an option is out of range
ChainResult solve_chain(const ChainProblem& problem, const ChainOptions& options = {});

/// Computes the energy [J] of a chain with these segment angles, and its gradient [N m]. The
/// component of the clamped segment is zero.
[[nodiscard]] double chain_energy(const ChainProblem& problem,
                                  const Eigen::Ref<const Eigen::VectorXd>& angles,
                                  Eigen::Ref<Eigen::VectorXd> gradient);

}  // namespace dlo::energy_model
