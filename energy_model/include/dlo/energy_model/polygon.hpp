#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "dlo/energy_model/chain.hpp"
#include "dlo/energy_model/status.hpp"
#include "dlo/obstacle/body.hpp"

namespace dlo::energy_model {

/// A point of a polygon that does not move.
struct HeldPoint {
  Eigen::Index point = 0;                              ///< 0 .. n
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
};

/// A body that pushes back what of a polygon is within it: its free points or, so that no edge and
/// no thin body goes unseen between them, points all along its segments.
struct PointObstacle {
  obstacle::Body body;   ///< [m]
  double stiffness = 0;  ///< force on a segment per depth [N/m], >= 0
  /// Points to a segment, each with its share of the stiffness, >= 1; 1: where segments meet
  /// (obstacle::samples_per_segment).
  int samples = 1;
};

/// Twist of a round rod between two held segments that hold its material frame. The angle theta is
/// that about the last segment from the first d1, brought along the polygon by the shortest turn
/// from segment to segment, to the last d1; its energy is theta^2 / (2 C) (Bergou et al., Discrete
/// elastic rods, SIGGRAPH 2008).
struct PolygonTwist {
  Eigen::Index first_segment = 0;                       ///< from point k to k+1
  Eigen::Index last_segment = 0;                        ///< > first_segment
  Eigen::Vector3d first_d1 = Eigen::Vector3d::UnitX();  ///< its part across the segment counts
  Eigen::Vector3d last_d1 = Eigen::Vector3d::UnitX();   ///< as `first_d1`
  double compliance = 0;                                ///< C = int ds / GJ [1/(N m)], > 0
  double angle = 0;  ///< theta is the branch nearest to this, whole turns counted [rad]
};

/// theta [rad]. @param points  of the whole polygon [m], 3 x (n+1)
[[nodiscard]] double polygon_twist_angle(const PolygonTwist& twist,
                                         const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// A polygon of elastic segments in space, held at any of its points: the force model's rod with
/// its own stretch stiffness c_c, so that its minimum is where the force model comes to rest
/// (energy_model/doc/polygon.md). Its energy [J], joints' potentials those of JointLaw with the
/// mean L of two rest lengths:
///
///     E = sum c_c (|d_i| - L_i)^2 / (2 L_i) + sum joints - sum F_i . P_i + sum c_e depth_i^2 / 2
///         + sum theta_k^2 / (2 C_k)
///
/// One whose joints are bent at rest lies in the plane z = 0 with all that holds it and acts on it;
/// nothing is said of its stability across that plane.
struct PolygonProblem {
  Eigen::VectorXd rest_lengths;          ///< L_i [m], n >= 2, each > 0
  double stretch_stiffness = 0;          ///< c_c [N], > 0
  Eigen::Matrix3Xd node_forces;          ///< dead force on each point [N], 3 x (n+1)
  JointLaw law = JointLaw::hooke;        ///< of every joint
  double stiffness = 0;                  ///< c_b [N] or EI [N m^2], > 0
  Eigen::VectorXd stiffnesses = {};      ///< as ChainProblem's
  Eigen::VectorXd natural_turns = {};    ///< as ChainProblem's, from x to y
  std::vector<HeldPoint> held;           ///< one or more, each point once
  std::vector<PointObstacle> obstacles;  ///< may be empty
  std::vector<PolygonTwist> twists;      ///< law hooke, without natural turns; may be empty
};

/// How far to minimise.
struct PolygonOptions {
  double tolerance = 1e-12;     ///< of Newton's step, RMS over the points, in polygon lengths; > 0
  int max_evaluations = 20000;  ///< of the energy
  /// Of the whole call [s], > 0; the status is then `time_limit`.
  double time_limit = std::numeric_limits<double>::infinity();
  /// Begin with a soft stretch stiffness; false: for a start that is nearly at rest.
  bool in_stages = true;
  /// What is done where second derivatives are negative. false: they are damped until none is, in
  /// small steps downhill to a minimum next to the start. true: terms that are negative are left
  /// out, in large steps to any minimum; soft polygons far from rest take a fifth of the
  /// evaluations.
  bool project_hessian = false;
};

/// A shape of a polygon, and how it was found.
struct [[nodiscard]] PolygonResult {
  SolveStatus status = SolveStatus::not_run;  ///< how it ended
  std::string message = "never ran";          ///< the same in words
  int evaluations = 0;                        ///< of energy and gradient
  double seconds = 0;                         ///< wall time [s]
  double residual = -1;                       ///< largest force on a free point [N]
  Eigen::Matrix3Xd points;                    ///< [m], 3 x (n+1)
  /// What holds each of PolygonProblem::held exerts, but against what obstacles do to the point
  /// [N].
  Eigen::Matrix3Xd grip_forces;
  double energy = 0;           ///< E [J]
  std::vector<double> twists;  ///< theta of each of PolygonProblem::twists [rad]
};

/// Minimises E by damped Newton steps over the free points (a banded matrix, GSL's LDL^T), each of
/// which must lower E, with c_c raised in stages (energy_model/doc/polygon.md); at a saddle it
/// leaves along the lowest mode. `converged` and `roundoff_limited` mean, at the points that are
/// returned: the Hessian over all free points, in space (with natural turns: in its plane), is
/// positive definite, to rounding; Newton's step is below 1e-7 polygon lengths; no force above 1e-6
/// of those that act is left on a free point, but for rounding. Else `not_verified`, and the
/// message has the number.
/// @param start  positions to start from [m], 3 x (n+1), no segment of zero length; held points
///               are put where they are held
/// @throws std::invalid_argument if the problem, an option or the start is out of range
PolygonResult solve_polygon(const PolygonProblem& problem,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                            const PolygonOptions& options = {});

/// The shape to which twist leads: the ends' frames are turned from where the polygon has them
/// without twist, little by little, each step from the shape before it and downhill where that has
/// lost its stability.
/// @param problem  with the twists that it is to have; `angle` is theta of `start`
/// @param start    at rest without twist [m], 3 x (n+1)
/// @throws std::invalid_argument as solve_polygon
PolygonResult twist_polygon(const PolygonProblem& problem,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& start,
                            const PolygonOptions& options = {});

/// Energy [J] of these points and its gradient [N], held points included.
/// @param[out] gradient  overwritten, 3 x (n+1)
[[nodiscard]] double polygon_energy(const PolygonProblem& problem,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                    Eigen::Ref<Eigen::Matrix3Xd> gradient);

}  // namespace dlo::energy_model
