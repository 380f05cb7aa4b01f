#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "frames/fit_frames.hpp"
#include "frames/frame_hessian.hpp"
#include "frames/planar_frames.hpp"
#include "frames/rod_frames.hpp"
#include "frames/span_shape.hpp"
#include "strain/contact_rows.hpp"
#include "strain/dead_loads.hpp"
#include "strain/grip_rows.hpp"
#include "strain/soft_contact.hpp"
#include "strain/span_unknowns.hpp"

namespace dlo::energy_model {

/// Bending plus load energy of a span over its unknowns, with constraints. Unknowns x in the plane:
/// the tangent's angle at the start (if no clamp fixes it) and the curvature coefficients of every
/// piece; in space those of RodFrames. Bending is half the square of the coefficients in both.
/// Where the ends' frames of a rod without material directors are held, the last unknown is the
/// angle psi by which the rod's frame is turned ahead of Bishop's at the end, whole turns counted,
/// times (GJ / EI / length)^(1/2): its square is twice the energy of twist. psi makes the end's
/// frame meet its clamp's. With material directors the frames are the rod's own.
///
/// L = E - sum mu . c: the multipliers mu are the forces (of positions) and torques (of end angles)
/// that the grips exert on the rod. value(), constraint() and hessian() allocate nothing, but for
/// obstacles and what the first Hessian takes.
class SpanEnergy {
 public:
  SpanEnergy() = default;
  SpanEnergy(const Span& span, int terms) { reset(span, terms); }
  /// Takes on another span; buffers of the same size are kept.
  void reset(const Span& span, int terms);

  [[nodiscard]] const Span& span() const { return span_; }
  [[nodiscard]] Eigen::Index size() const { return unknowns_.size(); }
  [[nodiscard]] Eigen::Index constraints() const {
    return grips_.positions() + contacts_.count() + grips_.directions();
  }
  /// Constraints on directions are the last ones.
  [[nodiscard]] Eigen::Index first_direction_row() const {
    return constraints() - grips_.directions();
  }
  [[nodiscard]] int terms() const { return static_cast<int>(unknowns_.terms); }
  [[nodiscard]] int pieces() const { return static_cast<int>(pieces_.size()); }
  [[nodiscard]] double longest_piece() const;

  /// Energy in EI/l and its gradient; known already where the last value() was, unless obstacles'
  /// multipliers may have moved on.
  [[nodiscard]] double value(const Eigen::Ref<const Eigen::VectorXd>& x,
                             Eigen::Ref<Eigen::VectorXd> gradient);
  /// Residuals of the constraints at the point of the last value(), and their Jacobian.
  void constraint(Eigen::Ref<Eigen::VectorXd> residual, Eigen::Ref<Eigen::MatrixXd> jacobian);
  /// Second derivatives of E - mu . c at the point of the last value().
  void hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixXd& result);
  /// For a planar span of a round rod without natural strains: the same for bending out of the
  /// plane, with its constraints' Jacobian. Unknowns are the rates of the tangent's tilt.
  /// second_derivatives_out_of_plane() is for all planar spans.
  void tilt_hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixXd& hessian,
                    Eigen::MatrixXd& jacobian);
  /// For a planar span held by one clamp and nothing else: whether bending out of the plane stores
  /// energy, at the point of the last value().
  [[nodiscard]] bool resists_out_of_plane();
  /// The point of the last value().
  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }

  /// Arc lengths of the nodes, and tangents there at the point of the last value(), 3 x nodes.
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return s_; }
  [[nodiscard]] Eigen::Matrix3Xd tangents() const { return t_.transpose(); }
  /// d1 of the rod's own frame there, of a span in space with material directors.
  [[nodiscard]] Eigen::Matrix3Xd d1() const { return state_.d1.bottomRows(s_.size()).transpose(); }
  /// Unknowns whose tangents, and with material directors frames, at the nodes come nearest to the
  /// given ones; a planar span drops what leaves its plane. Also turns the clamps' angles to the
  /// winding of these tangents.
  /// @param most_steps  that the fit may take in space, one evaluation each
  [[nodiscard]] Eigen::VectorXd fit(const StartShape& shape, int most_steps = most_fit_steps);

  /// What tangents at the nodes would cost a round rod that is intrinsically
  /// straight, and how far from the holds they would end, before they are fitted.
  struct Estimate {
    double energy = 0;
    double bending = 0;  // of it
    double gap = 0;
  };
  [[nodiscard]] Estimate estimate(const Eigen::Matrix3Xd& tangents) const;

  /// Turns the clamps' angles to the winding of these unknowns.
  void unwrap(const Eigen::Ref<const Eigen::VectorXd>& x);

  /// Unknowns of a shape that was found with another number of terms, or in the plane.
  [[nodiscard]] Eigen::VectorXd prolong(const SpanEnergy& other, const Eigen::VectorXd& x);

  [[nodiscard]] const SpanUnknowns& unknowns() const { return unknowns_; }

  /// Multipliers of the same span's constraints, found with another number of
  /// terms.
  [[nodiscard]] Eigen::VectorXd prolong_multipliers(const SpanEnergy& other,
                                                    const Eigen::VectorXd& multipliers) const;

  /// Truncation indicator, the size of the last coefficients: is the curvature resolved?
  [[nodiscard]] double truncation(const Eigen::VectorXd& x) const { return truncation(x, terms()); }
  /// The same of the last of the first `terms` coefficients.
  [[nodiscard]] double truncation(const Eigen::VectorXd& x, int terms) const;
  /// The rod's twist, end ahead of start [rad]; 0 where nothing holds it.
  [[nodiscard]] double twist(const Eigen::VectorXd& x) const;
  /// What the clamp at the end turns it with, about the tangent.
  [[nodiscard]] double twisting_torque(const Eigen::VectorXd& x,
                                       const Eigen::VectorXd& multipliers) const;
  /// Unknowns with this twist.
  [[nodiscard]] Eigen::VectorXd with_twist(Eigen::VectorXd x, double angle) const;
  /// d1 at the end, at the point of the last value(), of the frame with Span::first_d1() at the
  /// start, the rod's or Bishop's.
  [[nodiscard]] Eigen::Vector3d transported_d1() const { return state_.end_frame().col(0); }
  /// Turns the clamp at the end of a span whose frames are held.
  void turn_end_clamp(const Eigen::Vector3d& end_d1);

  [[nodiscard]] SpanShape shape(const Eigen::VectorXd& x) const;
  /// The shape of these unknowns, to start from.
  [[nodiscard]] TangentField field(const Eigen::VectorXd& x) const;
  [[nodiscard]] Energies energies(const Eigen::VectorXd& x);

  [[nodiscard]] const Piece& piece(Eigen::Index index) const {
    return pieces_[static_cast<std::size_t>(index)];
  }
  /// On which the nodes of each piece lie.
  [[nodiscard]] const LegendreTable& table() const { return *table_; }
  /// Derivatives of the tangents at the nodes by the unknowns but for the twist psi, at the point
  /// of the last value(): components x, y and z, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian();

  [[nodiscard]] bool has_soft_obstacles() const { return soft_contact_.any(); }
  [[nodiscard]] SoftContact& soft_contact() { return soft_contact_; }
  [[nodiscard]] const SoftContact& soft_contact() const { return soft_contact_; }
  /// What holds the rod on rigid obstacles by these multipliers.
  [[nodiscard]] std::vector<ContactForce> contact_forces(const Eigen::VectorXd& multipliers) const {
    return contacts_.forces(of_contacts(multipliers));
  }

  /// Where one of Span::contacts that slides is, at the point of the last value(); nothing of
  /// others.
  [[nodiscard]] std::optional<double> touches_at(std::size_t contact) const {
    return contacts_.touches_at(contact);
  }

  /// Torque of one of the span's holds and of the clamp at its start, at the point of the last
  /// value(): the weak forms, from the directors' multipliers and from the balance about the start.
  /// They converge with the energy, the curvature at the very end only with its last coefficients.
  [[nodiscard]] Eigen::Vector3d hold_torque(Eigen::Index hold, const Eigen::VectorXd& multipliers);
  [[nodiscard]] Eigen::Vector3d start_torque(const Eigen::VectorXd& multipliers);

 private:
  [[nodiscard]] Eigen::Index strains() const { return unknowns_.strains(); }
  [[nodiscard]] bool has_psi() const { return unknowns_.has_psi; }
  [[nodiscard]] PlanarPoint in_plane() { return {plane_, plane_state_, t_, x_}; }
  [[nodiscard]] SpatialPoint in_space() {
    return {frames_, state_, t_, has_psi() ? twist_root_ : 0, has_psi() ? twist(x_) : 0};
  }
  /// Between those of positions and of directions.
  [[nodiscard]] Eigen::VectorXd of_contacts(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
    return multipliers.segment(grips_.positions(), contacts_.count());
  }
  void carry(const Eigen::Ref<const Eigen::VectorXd>& multipliers);
  void carry_tilts(const Eigen::Ref<const Eigen::VectorXd>& multipliers);

  Span span_;
  std::vector<Piece> pieces_;
  SpanUnknowns unknowns_;
  double twist_root_ = 0;  // unknown by twist
  const LegendreTable* table_ = nullptr;
  Eigen::VectorXd s_, weights_;

  // Terms and constraints
  DeadLoads loads_;
  GripRows grips_;
  ContactRows contacts_;
  SoftContact soft_contact_;

  // In the plane
  PlanarFrames plane_;
  PlanarFrames::State plane_state_;
  // In space
  Eigen::Matrix3d start_frame_ = Eigen::Matrix3d::Identity();
  RodFrames frames_;
  RodFrames::State state_;
  FrameHessian frame_hessian_;

  // At the point of the last value(), nodes x 3
  Eigen::MatrixX3d t_;
  Eigen::MatrixX3d total_;  // -dE/dt, of all but bending: loads and the obstacles' beyond the node
  Eigen::VectorXd x_, gradient_;
  double energy_ = 0;
  bool evaluated_ = false;  // x_ is a point that value() has seen since reset()

  // Scratch
  Eigen::MatrixX3d carried_;                 // total_ and what grips and contacts add to it
  std::vector<Eigen::Vector3d> couples_;     // by piece
  std::vector<Eigen::Matrix3d> curvatures_;  // by piece
  Eigen::VectorXd along_, by_unknown_;
};

}  // namespace dlo::energy_model
