#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// The part of a rod between two clamps, or between a clamp and a free end, or a rod without
/// clamps. Own units (lengths in l, forces in EI/l^2), own frame: z is the axis against which the
/// tangent's elevation beta is measured,
///     t = (cos beta cos theta, cos beta sin theta, sin beta),
/// so that a planar span lies in x-y and has beta = 0. s runs from the span's start.
struct Span {
  struct Hold {
    double at = 0;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< from the anchor
  };
  struct Load {
    double at = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
  };
  /// A half-space's wall: one-sided springs along the rod, or rigid.
  struct Wall {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
    double offset = 0;  ///< normal . (anchor - point): clearance of the anchor
    double stiffness = std::numeric_limits<double>::infinity();  ///< per length
  };

  double length = 1;
  bool planar = true;
  std::optional<Eigen::Vector3d> start_direction;  ///< a clamp holds the start, which is the anchor
  std::optional<Eigen::Vector3d> end_direction;    ///< a clamp holds the end, the last of `holds`
  double anchor = 0;                               ///< s of the first grip
  std::vector<Hold> holds;                         ///< the other grips, by growing s
  Eigen::Vector3d weight = Eigen::Vector3d::Zero();
  std::vector<Load> loads;  ///< by growing s
  std::vector<Wall> walls;

  /// Sum of weight and loads, for scales.
  [[nodiscard]] double total_load() const;
};

/// A shape of a span, own units and frame.
struct SpanSamples {
  Eigen::Matrix3Xd points;  ///< from the anchor
  Eigen::Matrix3Xd tangents;
  Eigen::Matrix3Xd curvature;
};

/// Bending plus load energy of a span over its unknowns, with constraints. Unknowns x: for theta
/// the start angle (if no clamp fixes it) and the curvature coefficients of every piece; then the
/// same for beta unless the span is planar. Pieces end at loads and grips, where curvature has
/// kinks.
///
/// L = E - sum mu . c: the multipliers mu are the forces (of positions) and torques (of end angles)
/// that the grips exert on the rod. Nothing is allocated in the calls with buffers.
class SpanEnergy {
 public:
  SpanEnergy(const Span& span, int terms);

  [[nodiscard]] const Span& span() const { return span_; }
  [[nodiscard]] Eigen::Index size() const { return fields_ * columns_; }
  [[nodiscard]] Eigen::Index constraints() const { return constraints_; }
  [[nodiscard]] int terms() const { return terms_; }
  [[nodiscard]] int pieces() const { return static_cast<int>(pieces_.size()); }

  /// Energy in EI/l and its gradient.
  [[nodiscard]] double value(const Eigen::Ref<const Eigen::VectorXd>& x,
                             Eigen::Ref<Eigen::VectorXd> gradient);
  /// Residuals of the constraints at the point of the last value(), and their Jacobian.
  void constraint(Eigen::Ref<Eigen::VectorXd> residual, Eigen::Ref<Eigen::MatrixXd> jacobian) const;
  /// Second derivatives of E - mu . c at the point of the last value().
  void hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixXd& result);
  /// For a planar span: the same for bending out of the plane, with its constraints' Jacobian.
  void sideways(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixXd& hessian,
                Eigen::MatrixXd& jacobian) const;

  /// Arc lengths of the nodes.
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return s_; }
  /// Unknowns whose tangents at the nodes come nearest to the given ones (3 x nodes); a planar span
  /// drops what leaves its plane. Also turns the end clamp's angle to the winding of these
  /// tangents.
  [[nodiscard]] Eigen::VectorXd fit(const Eigen::Matrix3Xd& tangents);

  [[nodiscard]] double tail(const Eigen::VectorXd& x) const;
  [[nodiscard]] SpanSamples sample(const Eigen::VectorXd& x, const std::vector<double>& s) const;
  [[nodiscard]] Energies energies(const Eigen::VectorXd& x);
  /// Largest elevation |beta| at the nodes of the last value() [rad].
  [[nodiscard]] double elevation() const;

  // Walls. Rigid ones are met by an augmented Lagrangian whose multipliers live at the nodes.
  [[nodiscard]] bool has_walls() const { return !span_.walls.empty(); }
  /// Moves the multipliers of rigid walls towards complementarity. @return largest violation, in l
  double update_contact();
  /// Force of each wall on this span, at the point of the last value().
  [[nodiscard]] std::vector<Eigen::Vector3d> wall_forces() const;

  /// Torque of the grip at the span's end and of the clamp at its start, at the point of the last
  /// value(): the weak forms, from the end angles' multipliers and from the balance about the
  /// start. They converge with the energy, the curvature at the very end only with its last
  /// coefficients.
  [[nodiscard]] Eigen::Vector3d end_torque(const Eigen::VectorXd& multipliers) const;
  [[nodiscard]] Eigen::Vector3d start_torque(const Eigen::VectorXd& multipliers) const;

 private:
  struct Piece {
    double begin = 0;
    double length = 0;
  };

  void cut(const std::vector<double>& more_cuts);
  void add_wall_terms(double& energy);

  Span span_;
  int terms_;
  Eigen::Index fields_;       // 1 planar, 2 spatial
  Eigen::Index columns_ = 0;  // unknowns of one field
  Eigen::Index constraints_ = 0;
  Eigen::Index axes_;  // position components that are constrained, 2 or 3
  double start_theta_ = 0, start_beta_ = 0, end_theta_ = 0, end_beta_ = 0;
  std::vector<Piece> pieces_;
  Eigen::VectorXd s_, weights_;
  Eigen::MatrixXd angle_;      // of the nodes by unknown
  Eigen::MatrixXd slope_;      // derivative by s, of the nodes by unknown
  Eigen::VectorXd end_angle_;  // of the span's end by unknown
  Eigen::Matrix3Xd force_;     // weight of the node times the sum of weight and loads beyond it
  Eigen::MatrixXd reach_;      // per hold, weight of the node times -1, 0, 1
  Eigen::MatrixXd position_;   // of the nodes by tangent of the nodes; only with walls

  // At the point of the last value()
  Eigen::VectorXd theta_, beta_, kappa_;
  Eigen::Matrix3Xd t_, t_theta_, t_beta_, total_;
  Eigen::MatrixXd clearance_, contact_, pressure_;  // nodes x walls
  double contact_stiffness_ = 0;
  Eigen::VectorXd x_;
};

}  // namespace dlo::energy_model
