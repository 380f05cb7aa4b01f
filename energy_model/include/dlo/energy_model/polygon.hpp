#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/status.hpp"
#include "dlo/obstacle/body.hpp"

namespace dlo::energy_model {

/// A point of a polygon whose position is prescribed.
struct HeldPoint {
  Eigen::Index point = 0;                              ///< index of the point, 0 .. n
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// A body that pushes back the parts of a polygon within it: its free points, or points all along
/// its segments, so that no edge and no thin body stays undetected between the free points.
struct PointObstacle {
  obstacle::Body body;   ///< shape and position of the body [m]
  double stiffness = 0;  ///< force on a segment per depth [N/m], >= 0
  /// Sample points per segment, >= 1, each with its share of the stiffness. 1: only the points of
  /// the polygon (obstacle::samples_per_segment).
  int samples = 1;
  /// Stiffness of each segment [N/m], n numbers >= 0, instead of `stiffness`; empty: equal. A point
  /// where two segments meet has their mean.
  Eigen::VectorXd stiffnesses = {};
};

/// Twist of a round rod between two clamped segments that hold its material frame. The first d1 is
/// transported along the polygon by the shortest rotation from segment to segment. Its angle theta
/// from there to the last d1, about the last segment, has the energy theta^2 / (2 C) (Bergou et
/// al., Discrete elastic rods, SIGGRAPH 2008).
struct PolygonTwist {
  Eigen::Index first_segment = 0;  ///< index k of the segment from point k to k+1
  Eigen::Index last_segment = 0;   ///< index of the last segment, > first_segment
  /// First director; only its part across the segment is used.
  Eigen::Vector3d first_d1 = Eigen::Vector3d::UnitX();
  /// First director at the last segment; only its part across the segment is used.
  Eigen::Vector3d last_d1 = Eigen::Vector3d::UnitX();
  double compliance = 0;  ///< torsional compliance C = int ds / GJ [1/(N m)], > 0
  /// Reference angle [rad]: theta is the branch nearest to it, whole turns counted.
  double angle = 0;
};

/// Returns the twist angle theta [rad]. @param points  points of the whole polygon [m], 3 x (n+1)
[[nodiscard]] double polygon_twist_angle(const PolygonTwist& twist,
                                         const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// A polygon of elastic segments in space, held at any of its points. It is the force model's rod
/// with its stretch stiffness c_c, so that its energy minimum is the shape at which the force model
/// comes to rest (energy_model/doc/polygon.md). Its energy [J], with the potentials of JointLaw for
/// the joints and the mean L of two rest lengths:
///
///     E = sum c_c (|d_i| - L_i)^2 / (2 L_i) + sum joints - sum F_i . P_i + sum c_e depth_i^2 / 2
///         + sum theta_k^2 / (2 C_k)
///
/// A polygon whose joints are bent at rest has to lie in the plane z = 0 with its grips and all
/// forces on it; its stability across that plane is not judged.
struct PolygonProblem {
  Eigen::VectorXd rest_lengths;    ///< rest lengths L_i [m], n >= 2, each > 0
  double stretch_stiffness = 0;    ///< stretch stiffness c_c [N], > 0
  Eigen::Matrix3Xd node_forces;    ///< dead force on each point [N], 3 x (n+1)
  JointLaw law = JointLaw::hooke;  ///< law of every joint
  double stiffness = 0;  ///< bending stiffness: c_b [N] for law paper, else EI [N m^2]; > 0
  Eigen::VectorXd stiffnesses = {};      ///< see ChainProblem::stiffnesses
  Eigen::VectorXd natural_turns = {};    ///< see ChainProblem::natural_turns; positive from x to y
  std::vector<HeldPoint> held;           ///< prescribed points, one or more, each point once
  std::vector<PointObstacle> obstacles;  ///< may be empty
  std::vector<PolygonTwist> twists;  ///< may be empty; not allowed with law paper or natural turns
};

/// Tolerance and limits of a minimisation.
struct PolygonOptions {
  double tolerance = 1e-12;     ///< RMS of Newton's step over the points, in polygon lengths; > 0
  int max_evaluations = 20000;  ///< maximum number of energy evaluations
  /// Time limit of the whole call [s], > 0. A call that reaches it returns `time_limit`.
  double time_limit = std::numeric_limits<double>::infinity();
  /// Whether to begin with a smaller stretch stiffness; false: for a start that is nearly at rest.
  bool in_stages = true;
  /// Treatment of negative second derivatives. false: the Hessian is damped until it is positive,
  /// which makes small steps downhill to a minimum near the start. true: negative terms are
  /// omitted, which makes large steps to any minimum; soft polygons far from rest then need a fifth
  /// of the evaluations.
  bool project_hessian = false;
};

/// Shape of a polygon and outcome of its minimisation.
struct [[nodiscard]] PolygonResult {
  SolveStatus status = SolveStatus::not_run;  ///< outcome
  std::string message = "never ran";          ///< the status in words
  int evaluations = 0;                        ///< evaluations of energy and gradient
  double seconds = 0;                         ///< wall time [s]
  double residual = -1;                       ///< largest force on a free point [N]
  Eigen::Matrix3Xd points;                    ///< [m], 3 x (n+1)
  /// Force of the grip on each point of PolygonProblem::held [N], without the part that balances
  /// forces of obstacles on that point.
  Eigen::Matrix3Xd grip_forces;
  double energy = 0;           ///< energy E [J]
  std::vector<double> twists;  ///< angle theta of each of PolygonProblem::twists [rad]
};

/// Minimises E by damped Newton steps over the free points (a banded matrix, GSL's LDL^T), none of
/// which increases E beyond rounding, with c_c increased in stages (energy_model/doc/polygon.md). A
/// saddle is left along the lowest mode. `converged` and `roundoff_limited` claim three conditions
/// at the returned points, up to rounding: the Hessian over all free points in space (with natural
/// turns: in its plane) is positive definite; Newton's step is below 1e-7 polygon lengths; the
/// residual force on each free point is at most 1e-10 of the forces that act. If one does not hold,
/// the status is `not_verified` instead, and the message states the cause.
/// @param start  initial positions [m], 3 x (n+1), no segment of zero length; held points are moved
///               to their prescribed positions
/// @throws std::invalid_argument if the problem, an option or the start is out of range
PolygonResult solve_polygon(const PolygonProblem& problem,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                            const PolygonOptions& options = {});

/// Follows the shape while the end frames are rotated in small steps from their twist-free rotation
/// to the prescribed one. Each step starts from the shape of the previous step, extrapolated
/// linearly unless that step has jumped or this one is repeated, and descends to a minimum if that
/// shape has lost its stability.
/// @param problem  problem with the twists of the result; `angle` is theta of `start`
/// @param start    equilibrium without twist [m], 3 x (n+1)
/// @throws std::invalid_argument as solve_polygon
PolygonResult twist_polygon(const PolygonProblem& problem,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                            const PolygonOptions& options = {});

/// Computes the energy [J] of these points and its gradient [N], held points included.
/// @param[out] gradient  overwritten, 3 x (n+1)
[[nodiscard]] double polygon_energy(const PolygonProblem& problem,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                    Eigen::Ref<Eigen::Matrix3Xd> gradient);

}  // namespace dlo::energy_model
