#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "dynamics/span_contact.hpp"
#include "frames/fit_frames.hpp"
#include "frames/frame_hessian.hpp"
#include "frames/frame_spins.hpp"
#include "frames/position_operator.hpp"
#include "frames/rod_frames.hpp"
#include "frames/span_shape.hpp"

namespace dlo::energy_model {

/// A vector and its first two derivatives by time, as components along axes at one time.
struct Moving {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// A direction that turns with the clamp at the end, and the director that stays across it.
struct AcrossDirector {
  Moving direction;
  bool of_d1 = false;  ///< not of the tangent
};

/// What grips do with a span at one time. Own units; components along the axes that turn with the
/// clamp at the start (the span's frame where there is none).
struct SpanDrive {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();   ///< from the span's frame to these axes
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();       ///< angular velocity of the axes
  Eigen::Vector3d spin_rate = Eigen::Vector3d::Zero();  ///< and its derivative
  /// Positions, seen from where the anchor was at first: of the anchor and of Span::holds.
  std::vector<Moving> grips;
  /// What directors of the last cross-section have no component along, where a clamp holds it.
  std::vector<AcrossDirector> across_end;
  Eigen::Vector3d end_spin = Eigen::Vector3d::Zero();  ///< of that clamp
  std::vector<BodyPlace> obstacles;                    ///< of the problem's
};

/// What a span has besides its shape; own units.
struct SpanInertia {
  std::vector<double> per_length;  ///< mass, by piece
  std::vector<PointMass> points;   ///< each where a piece begins or ends
  double material_damping = 0;     ///< tau
  double drag = 0;                 ///< per length
  double quadratic_drag = 0;       ///< per length, across the rod, by the squared velocity
};

/// Adds so many times each entry.
void add(const EnergyBalance& of, double times, EnergyBalance& to);

/// Equations of motion of a span in its strains x,
///     int (rho A r'' + c r' + q |v| v).dr ds + x.dx + tau x'.dx = int w.dr ds + loads + grips +
///     obstacles,
/// for all dx that move r, with r' and r'' from x', x'' by the spins of cross-sections
/// (frame_spins()),
///     t' = omega x t,  t'' = alpha x t + omega x t'.
/// Rates of vectors are those in space. What has mass are the points of a SpanReach.
///
/// With material directors x has the strains of twist as well. Points alone would leave those
/// without inertia where they move nothing; theirs is T^2 per strain energy, T = twist_time.
class SpanDynamics {
 public:
  /// @param span   whose Span::twist holds the last cross-section's d1, of one with material
  ///               directors; a planar one keeps to its plane
  /// @param first  tangent at the start, of a span that no clamp holds there
  SpanDynamics(Span span, int terms, const Eigen::Vector3d& first, SpanInertia inertia,
               const ContactLaw& contact);

  [[nodiscard]] Eigen::Index size() const { return elastic_.size(); }
  [[nodiscard]] Eigen::Index constraints() const { return constraints_; }
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return nodes_.nodes(); }
  /// Unknowns of a shape that has nearly these tangents, and frames, at the nodes, along the axes
  /// of a drive.
  [[nodiscard]] Eigen::VectorXd fit(const StartShape& shape) const;

  /// Takes in positions, velocities and accelerations; all below is at the last one.
  void move(const SpanDrive& drive, const Eigen::Ref<const Eigen::VectorXd>& x,
            const Eigen::Ref<const Eigen::VectorXd>& v, const Eigen::Ref<const Eigen::VectorXd>& a);

  /// Of the equations of motion, with the grips' multipliers; zero if they hold.
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  /// Of the points.
  [[nodiscard]] const Eigen::MatrixX3d& velocities() const { return velocity_; }
  /// What the change of the points' momentum from these velocities does along the unknowns; zero
  /// where only grips strike.
  [[nodiscard]] Eigen::VectorXd impulse(const Eigen::MatrixX3d& before);
  /// Residuals of the constraints: positions, velocities and accelerations, a column
  /// each.
  [[nodiscard]] Eigen::MatrixX3d constraint_residuals() const;
  /// Derivatives of the constraints by x.
  [[nodiscard]] Eigen::MatrixXd jacobian();
  [[nodiscard]] Eigen::MatrixXd mass_matrix();
  /// Derivatives of the residual by x, at these accelerations and multipliers, but for those of
  /// the accelerations in space; and by v, but for those of gyroscopic terms.
  [[nodiscard]] Eigen::MatrixXd stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  [[nodiscard]] Eigen::MatrixXd damping(const Eigen::MatrixXd& mass);

  /// What is dissipated, lost and done aside.
  [[nodiscard]] EnergyBalance energies() const;
  /// Of SpanDrive::grips on the span, with these multipliers; torques about each.
  [[nodiscard]] std::vector<Reaction> reactions(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  /// What is dissipated, lost and done, by time.
  [[nodiscard]] EnergyBalance power(const std::vector<Reaction>& reactions) const;
  /// On the span, at each point within one, by the obstacle's index in the problem.
  [[nodiscard]] std::vector<std::pair<std::size_t, Eigen::Vector3d>> obstacle_forces() const;
  [[nodiscard]] bool may_touch() const { return !grid_.empty(); }
  /// Whether strains of twist are among the unknowns, which vibrate much faster than all else.
  [[nodiscard]] bool has_twist() const { return twist_inertia_.size() > 0; }
  /// By which it is within a rigid obstacle where it is most; 0: nowhere.
  [[nodiscard]] double depth() const;

  /// The shape along the span's own frame.
  [[nodiscard]] SpanShape shape(const Eigen::VectorXd& x) const;

 private:
  [[nodiscard]] Eigen::Index all_unknowns() const { return frames_.fields() * frames_.columns(); }
  [[nodiscard]] Eigen::VectorXd full(const Eigen::Ref<const Eigen::VectorXd>& part) const;
  /// That an AcrossDirector speaks of.
  [[nodiscard]] const Moving& director(const AcrossDirector& across) const {
    return across.of_d1 ? end_d1_ : end_tangent_;
  }
  void drag_across();
  void collect_soft_touches();
  void collect_touches();
  [[nodiscard]] Eigen::MatrixX3d at_tangents(const Touch& touch,
                                             const Eigen::Vector3d& force) const;
  [[nodiscard]] Eigen::VectorXd pulled(const FrameGradient& f);
  [[nodiscard]] Eigen::MatrixX3d all_by_tangents(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> couples(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void add_touches(double Touch::*derivative, Eigen::MatrixXd& matrix);
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
  SpanReach points_;
  ContactGrid grid_;
  Eigen::Index constraints_ = 0, axes_ = 3;
  Eigen::VectorXd elastic_;                 // by unknown; 0 of a free start's turn
  Eigen::VectorXd twist_inertia_;           // the same; 0 but of twist; empty: none
  std::vector<Eigen::Index> held_;          // point of each hold
  std::vector<std::vector<double>> signs_;  // PositionOperator::signs() of each hold
  // Of the points; forces along the span's frame.
  Eigen::VectorXd masses_;
  Eigen::MatrixX3d gravity_, loads_;

  // At the last move()
  SpanDrive drive_;
  Eigen::VectorXd x_, v_, a_;
  Eigen::MatrixX3d t_, t_rate_;                          // of the nodes
  Eigen::MatrixX3d position_, velocity_, acceleration_;  // of the points, in space
  Moving end_tangent_, end_d1_;
  Eigen::MatrixX3d quadratic_drag_;  // of the points; empty: none
  double mean_drag_ = 0;             // drag and the change of quadratic drag, per length
  Eigen::MatrixX3d forces_;          // of the points: inertia and drag less what pulls and yields
  std::vector<Touch> soft_touches_;  // of points, which are in forces_
  std::vector<Touch> touches_;       // of the grid's points
};

}  // namespace dlo::energy_model
