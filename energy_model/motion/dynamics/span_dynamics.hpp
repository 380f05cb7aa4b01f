#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dynamics/span_contact.hpp"
#include "frames/fit_frames.hpp"
#include "frames/frame_hessian.hpp"
#include "frames/position_operator.hpp"
#include "frames/rod_frames.hpp"
#include "frames/span_shape.hpp"

namespace dlo::energy_model {

/// A vector and its first two time derivatives, as components along axes at one time.
struct VectorMotion {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// Returns the motion of a vector that rotates with an angular velocity and acceleration.
[[nodiscard]] VectorMotion rotating_vector(const Eigen::Vector3d& vector,
                                           const Eigen::Vector3d& spin,
                                           const Eigen::Vector3d& spin_rate);

/// A direction that rotates with the clamp at the end, and the director that stays normal to it.
struct AcrossDirector {
  VectorMotion direction;
  bool of_d1 = false;  ///< whether the director is d1 instead of the tangent
};

/// Motion that grips and obstacles prescribe for a span at one time. Own units; components along
/// axes that rotate with the clamp at the start (the span's frame if there is none).
struct SpanDrive {
  /// Rotation from the span's frame to the axes of this struct.
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();       ///< angular velocity of the axes
  Eigen::Vector3d spin_rate = Eigen::Vector3d::Zero();  ///< angular acceleration of the axes
  /// Positions of the anchor and of Span::holds relative to the anchor's initial position.
  std::vector<VectorMotion> grips;
  /// Directions to which directors of the last cross-section stay normal, if a clamp holds it.
  std::vector<AcrossDirector> across_end;
  Eigen::Vector3d end_spin = Eigen::Vector3d::Zero();  ///< angular velocity of the clamp at the end
  std::vector<ObstaclePose> obstacles;                 ///< the problem's obstacles, by index
};

/// Mass and damping of a span, in its own units.
struct SpanInertia {
  std::vector<double> per_length;  ///< mass per length, by element
  std::vector<PointMass> points;   ///< each at the begin or end of an element
  double material_damping = 0;     ///< relaxation time tau
  double drag = 0;                 ///< drag coefficient per length
  /// Coefficient per length of the drag normal to the rod that grows as the squared velocity.
  double quadratic_drag = 0;
};

/// Adds `times` times each entry of `of` to `to`.
void add(const EnergyBalance& of, double times, EnergyBalance& to);

/// Equations of motion of a span in its strains x,
///     int (rho A r'' + c r' + q |v| v).dr ds + x.dx + tau x'.dx = int w.dr ds + loads + grips +
///     obstacles,
/// for all dx that move r. r' and r'' follow from x', x'' by the angular velocities of
/// cross-sections (frame_spins()),
///     t' = omega x t,  t'' = alpha x t + omega x t'.
/// Rates of vectors are relative to space. The points of a SpanPointOperator carry the mass.
///
/// With material directors x includes the strains of twist. Point masses alone would give no
/// inertia to twist that moves no point; twist therefore gets the inertia T^2 per strain energy, T
/// = twist_relaxation_time.
class SpanDynamics {
 public:
  /// @param span   with material directors: Span::twist prescribes the last cross-section's d1; a
  ///   planar span stays in its plane
  /// @param first  tangent at the start, for a span without a clamp there
  SpanDynamics(Span span, int terms, const Eigen::Vector3d& first, SpanInertia inertia,
               const ContactLaw& contact);

  [[nodiscard]] Eigen::Index size() const { return elastic_.size(); }
  [[nodiscard]] Eigen::Index constraints() const { return constraints_; }
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return nodes_.nodes(); }
  /// Returns the unknowns of a shape that has nearly these tangents, and frames, at the nodes,
  /// along the axes of a drive.
  [[nodiscard]] Eigen::VectorXd fit(const StartShape& shape) const;

  /// Sets positions, velocities and accelerations; all functions below refer to the last call.
  void move(const SpanDrive& drive, const Eigen::Ref<const Eigen::VectorXd>& x,
            const Eigen::Ref<const Eigen::VectorXd>& v, const Eigen::Ref<const Eigen::VectorXd>& a);

  /// Returns the residual of the equations of motion with the grips' multipliers; zero if they
  /// hold.
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  /// Velocities of the points.
  [[nodiscard]] const Eigen::MatrixX3d& velocities() const { return velocity_; }
  /// Returns the component along the unknowns of the points' change of momentum from these
  /// velocities: jacobian()^T times the impulses of the grips if no other impulses act.
  [[nodiscard]] Eigen::VectorXd impulse(const Eigen::MatrixX3d& before);
  /// Residuals of the constraints: of positions, velocities and accelerations, one column each.
  [[nodiscard]] Eigen::MatrixX3d constraint_residuals() const;
  /// Derivatives of the constraints by x.
  [[nodiscard]] Eigen::MatrixXd jacobian();
  [[nodiscard]] Eigen::MatrixXd mass_matrix();
  /// Derivatives of the residual at these accelerations and multipliers: stiffness() by x, without
  /// the derivatives of forces_ (accelerations in space, drag and soft obstacles); damping() by v,
  /// without gyroscopic terms and with the mean of the drag.
  [[nodiscard]] Eigen::MatrixXd stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  [[nodiscard]] Eigen::MatrixXd damping(const Eigen::MatrixXd& mass);

  /// Returns the energies; dissipated, lost and done work are not included.
  [[nodiscard]] EnergyBalance energies() const;
  /// Returns forces and torques of SpanDrive::grips on the span with these multipliers; each torque
  /// is about its grip.
  [[nodiscard]] std::vector<Reaction> reactions(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  /// Returns dissipated power, lost power and the power of grips and obstacles.
  [[nodiscard]] EnergyBalance power(const std::vector<Reaction>& reactions) const;
  /// Returns the obstacle's force on the span at each point within one, with the obstacle's index
  /// in the problem.
  [[nodiscard]] std::vector<std::pair<std::size_t, Eigen::Vector3d>> obstacle_forces() const;
  [[nodiscard]] bool may_touch() const { return !grid_.empty(); }
  /// Whether strains of twist are among the unknowns; they vibrate much faster than the others.
  [[nodiscard]] bool has_twist() const { return twist_inertia_.size() > 0; }
  /// Returns the largest depth within a rigid obstacle; 0 without contact.
  [[nodiscard]] double depth() const;

  /// Returns the shape along SpanDrive's axes.
  [[nodiscard]] SpanShape shape(const Eigen::VectorXd& x) const;

 private:
  [[nodiscard]] Eigen::Index full_size() const { return frames_.fields() * frames_.columns(); }
  [[nodiscard]] Eigen::VectorXd full(const Eigen::Ref<const Eigen::VectorXd>& part) const;
  /// Returns the director that an AcrossDirector refers to.
  [[nodiscard]] const VectorMotion& director(const AcrossDirector& across) const {
    return across.of_d1 ? end_d1_ : end_tangent_;
  }
  void add_quadratic_drag();
  void collect_soft_contact_points();
  void collect_contact_points();
  [[nodiscard]] Eigen::MatrixX3d tangent_gradient(const ContactPoint& touch,
                                                  const Eigen::Vector3d& force) const;
  [[nodiscard]] Eigen::VectorXd frame_adjoint(const FrameGradient& f);
  [[nodiscard]] Eigen::MatrixX3d work_gradient(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> couples(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void add_contact_derivatives(double ContactPoint::*derivative, Eigen::MatrixXd& matrix);
  [[nodiscard]] Eigen::Vector3d multiplier_force(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers, std::size_t hold) const;

  Span span_;
  int terms_;
  SpanInertia inertia_;
  Eigen::Matrix3d start_frame_;
  RodFrames frames_;
  RodFrames::State state_;
  FrameHessian frame_hessian_;
  PositionOperator nodes_;
  SpanPointOperator points_;
  ContactGrid grid_;
  Eigen::Index constraints_ = 0, axes_ = 3;
  Eigen::VectorXd elastic_;                // one per unknown: 0 for a free start's rotation, else 1
  Eigen::VectorXd twist_inertia_;          // by unknown; 0 except for twist; empty without twist
  std::vector<Eigen::Index> grip_points_;  // point of each grip beyond the first
  std::vector<std::vector<double>> signs_;  // PositionOperator::signs() of each of these grips
  // Quantities of the points; forces along the span's frame.
  Eigen::VectorXd masses_;
  Eigen::MatrixX3d gravity_, loads_;

  // State of the last move()
  SpanDrive drive_;
  Eigen::VectorXd x_, v_, a_;
  Eigen::MatrixX3d t_, t_rate_;                          // tangents at the nodes and their rates
  Eigen::MatrixX3d position_, velocity_, acceleration_;  // motion of the points in space
  VectorMotion end_tangent_, end_d1_;
  Eigen::MatrixX3d quadratic_drag_;  // minus its forces on the points; empty if there is none
  double mean_drag_ = 0;             // drag plus the derivative of quadratic drag, per length
  // Forces of the points: inertia and drag minus loads and soft obstacles.
  Eigen::MatrixX3d forces_;
  std::vector<ContactPoint> soft_contact_points_;  // at the points; included in forces_
  std::vector<ContactPoint> contact_points_;       // at the grid's points
};

}  // namespace dlo::energy_model
