#pragma once

#include <Eigen/Core>
#include <vector>

#include "dynamics/span_contact.hpp"
#include "strain/rod_frames.hpp"
#include "strain/span_shape.hpp"

namespace dlo::energy_model {

/// A vector and its first two derivatives by time, as components along axes at one time.
struct Moving {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();
};

/// What grips do with a span at one time. Own units; components along the axes that turn with the
/// clamp at the start (the span's frame where there is none).
struct SpanDrive {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();   ///< from the span's frame to these axes
  Moving anchor;                                        ///< its value from where it was at first
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();       ///< angular velocity of the axes
  Eigen::Vector3d spin_rate = Eigen::Vector3d::Zero();  ///< and its derivative
  std::vector<Moving> holds;                            ///< of Span::holds, value from the anchor
  /// Directions across that of the clamp at the end, which the tangent there has none of.
  std::vector<Moving> across_end;
  Eigen::Vector3d end_spin = Eigen::Vector3d::Zero();  ///< of that clamp
  std::vector<BodyPlace> soft_obstacles;               ///< of Span::soft_obstacles
  std::vector<BodyPlace> rigid_obstacles;              ///< of Span::rigid_obstacles
};

/// What a span has besides its shape; own units.
struct SpanInertia {
  std::vector<double> per_length;   ///< by piece
  std::vector<double> at_stations;  ///< point masses at the pieces' begins and the span's end
  double material_damping = 0;      ///< tau
  double drag = 0;                  ///< per length
};

/// Unknowns, their rates and second derivatives.
struct SpanState {
  Eigen::VectorXd x, v;
};

/// Of the points.
struct SpanVelocities {
  Eigen::MatrixX3d nodes;
  std::vector<Eigen::Vector3d> stations;
};

/// What moves energy.
struct SpanPower {
  double work = 0;        ///< of grips and of obstacles that move on the span, by time
  double dissipated = 0;  ///< in the material and the air, by time
  double lost = 0;        ///< to what rigid obstacles resist with, by time
};

struct SpanEnergies {
  double kinetic = 0, bending = 0, gravity = 0, load = 0, obstacles = 0;
};

/// Forces and torques of the grips on a span along SpanDrive's axes, torques about each.
struct SpanReactions {
  Eigen::Vector3d anchor_force = Eigen::Vector3d::Zero();
  Eigen::Vector3d anchor_torque = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> hold_forces;
  Eigen::Vector3d end_torque = Eigen::Vector3d::Zero();
};

/// Equations of motion of a span in its strains x,
///     int rho A r''.dr + c r'.dr ds + x.dx + tau x'.dx = int w.dr ds + loads + grips + obstacles,
/// for all dx that move r, with r' and r'' from x', x'' by the angular velocity of cross-sections,
///     omega_s = R u',  alpha_s = R u'' + omega x R u',  t' = omega x t,  t'' = alpha x t + omega x
///     t',
/// collocated as the directors are. Rates of vectors are those in space.
class SpanDynamics {
 public:
  /// @param span   without material directors
  /// @param planar  keeps to the span's plane
  /// @param first  tangent at the start, of a span that no clamp holds there
  SpanDynamics(Span span, std::vector<Piece> pieces, int terms, bool planar,
               const Eigen::Vector3d& first, SpanInertia inertia, const ContactLaw& contact);

  [[nodiscard]] Eigen::Index size() const { return size_; }
  [[nodiscard]] Eigen::Index constraints() const { return constraints_; }
  [[nodiscard]] bool planar() const { return planar_; }
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return s_; }
  /// Unknowns of a shape that has nearly these tangents at the nodes, along the axes of a drive.
  [[nodiscard]] Eigen::VectorXd fit(const Eigen::Matrix3Xd& tangents) const;

  /// Takes in positions, velocities and accelerations; all below is at the last one.
  void move(const SpanDrive& drive, const Eigen::Ref<const Eigen::VectorXd>& x,
            const Eigen::Ref<const Eigen::VectorXd>& v, const Eigen::Ref<const Eigen::VectorXd>& a);

  /// Of the equations of motion, with the grips' multipliers; zero if they hold.
  [[nodiscard]] Eigen::VectorXd residual(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  [[nodiscard]] SpanVelocities velocities() const;
  /// What the change of the points' momentum from these velocities does along the unknowns; zero
  /// where only grips strike.
  [[nodiscard]] Eigen::VectorXd impulse(const SpanVelocities& before);
  /// By how much the constraints are missed: positions, velocities and accelerations, a column
  /// each.
  [[nodiscard]] Eigen::MatrixX3d misses() const;
  /// Derivatives of the constraints by x.
  [[nodiscard]] Eigen::MatrixXd jacobian();
  [[nodiscard]] Eigen::MatrixXd mass_matrix();
  /// Derivatives of the residual by x, at these accelerations and multipliers, but for those of
  /// the accelerations in space; and by v, but for those of gyroscopic terms.
  [[nodiscard]] Eigen::MatrixXd stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  [[nodiscard]] Eigen::MatrixXd damping(const Eigen::MatrixXd& mass);

  [[nodiscard]] SpanEnergies energies() const;
  /// With these multipliers, for which residual() has been asked last.
  [[nodiscard]] SpanReactions reactions(const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  [[nodiscard]] SpanPower power(const SpanReactions& reactions) const;
  /// Of each of Span::soft_obstacles on the span.
  [[nodiscard]] const std::vector<Eigen::Vector3d>& obstacle_forces() const { return pushed_; }
  /// Of each of Span::rigid_obstacles.
  [[nodiscard]] std::vector<Eigen::Vector3d> rigid_forces() const;
  [[nodiscard]] bool may_touch() const { return !grid_.empty(); }
  /// By which it is within a rigid obstacle where it is most; 0: nowhere.
  [[nodiscard]] double depth() const;

  /// The shape along the span's own frame.
  [[nodiscard]] SpanShape shape(const Eigen::VectorXd& x) const;

 private:
  [[nodiscard]] Eigen::VectorXd full(const Eigen::Ref<const Eigen::VectorXd>& part) const;
  [[nodiscard]] Eigen::MatrixX3d rates(const Eigen::VectorXd& full) const;
  [[nodiscard]] Eigen::Index nodes_of_piece() const { return table_->nodes.size(); }
  void collect_forces();
  void collect_soft_obstacles();
  void collect_touches();
  /// A force at a point of the grid.
  struct GridForce {
    std::size_t piece = 0;
    Eigen::Index point = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
  };
  [[nodiscard]] Eigen::MatrixX3d by_tangents(const Eigen::MatrixX3d& at_nodes,
                                             const std::vector<Eigen::Vector3d>& at_stations,
                                             const std::vector<GridForce>& at_grid) const;
  [[nodiscard]] Eigen::VectorXd pulled(const Eigen::MatrixX3d& tangents,
                                       const std::vector<Eigen::Vector3d>& couples);
  [[nodiscard]] Eigen::MatrixX3d all_by_tangents(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> couples(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void add_geometric_stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                               Eigen::MatrixXd& stiffness);
  [[nodiscard]] Eigen::VectorXd depth_gradient(const Touch& touch);
  [[nodiscard]] Eigen::Vector3d multiplier_force(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers, std::size_t hold) const;

  Span span_;
  std::vector<Piece> pieces_;
  int terms_;
  bool planar_;
  bool free_start_;
  SpanInertia inertia_;
  Eigen::Matrix3d start_frame_;
  RodFrames frames_;
  RodFrames::State state_;
  const LegendreTable* table_;
  ContactGrid grid_;
  Eigen::VectorXd s_;
  Eigen::Index size_ = 0, constraints_ = 0, axes_ = 3;
  Eigen::VectorXd elastic_;
  std::size_t anchor_station_ = 0;
  std::vector<std::size_t> hold_stations_;
  std::vector<Eigen::Vector3d> station_loads_;  // along the span's frame

  // At the last move()
  SpanDrive drive_;
  Eigen::VectorXd x_, v_;
  Eigen::MatrixX3d omega_, alpha_;  // nodes, those of a free start's turn first
  Eigen::MatrixX3d t_rate_;         // of tangents at the pieces' nodes
  Eigen::MatrixX3d position_, velocity_, acceleration_;  // of the pieces' nodes, in space
  std::vector<Moving> stations_;                         // the same of the pieces' ends
  Moving end_tangent_;
  Eigen::MatrixX3d forces_;  // inertia and drag less what pulls, at nodes
  std::vector<Eigen::Vector3d> station_forces_;
  std::vector<Eigen::Vector3d> pushed_;
  double obstacle_energy_ = 0, obstacle_work_ = 0;  // of soft ones; the latter by time
  std::vector<Touch> touches_;                      // by piece
};

}  // namespace dlo::energy_model
