#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/energy_model/problem.hpp"
#include "frames/fit_frames.hpp"
#include "frames/planar_frames.hpp"
#include "frames/rod_frames.hpp"
#include "frames/span_shape.hpp"
#include "strain/contact_rows.hpp"
#include "strain/dead_loads.hpp"
#include "strain/grip_rows.hpp"
#include "strain/soft_contact.hpp"
#include "strain/span_point.hpp"
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
/// that the grips exert on the rod. evaluate() and hessian() allocate nothing once a point has its
/// size, but for obstacles.
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

  /// Of what the model's values are: another one after reset(), and whatever turns a clamp.
  [[nodiscard]] long revision() const { return revision_; }
  /// Energy, gradient and constraints at x.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, SpanPoint& point) const;
  [[nodiscard]] SpanPoint evaluated(const Eigen::Ref<const Eigen::VectorXd>& x) const {
    SpanPoint point;
    evaluate(x, point);
    return point;
  }
  /// Second derivatives of E - mu . c.
  void hessian(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
               Eigen::MatrixXd& result) const;
  /// For a planar span of a round rod without natural strains: the same for bending out of the
  /// plane, with its constraints' Jacobian. Unknowns are the rates of the tangent's tilt.
  /// second_derivatives_out_of_plane() is for all planar spans.
  void tilt_hessian(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                    Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) const;
  /// For a planar span held by one clamp and nothing else: whether bending out of the plane stores
  /// energy.
  [[nodiscard]] bool resists_out_of_plane(SpanPoint& at) const;

  /// Arc lengths of the nodes.
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return s_; }
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
  /// Turns the clamp at the end of a span whose frames are held.
  void turn_end_clamp(const Eigen::Vector3d& end_d1);

  [[nodiscard]] SpanShape shape(const Eigen::VectorXd& x) const;
  /// The shape of these unknowns, to start from.
  [[nodiscard]] TangentField field(const Eigen::VectorXd& x) const;
  [[nodiscard]] Energies energies(const SpanPoint& at) const;

  [[nodiscard]] const Piece& piece(Eigen::Index index) const {
    return pieces_[static_cast<std::size_t>(index)];
  }
  /// On which the nodes of each piece lie.
  [[nodiscard]] const LegendreTable& table() const { return *table_; }
  /// Derivatives of the tangents at the nodes by the unknowns but for the twist psi: components x,
  /// y and z, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(SpanPoint& at) const;

  [[nodiscard]] bool has_soft_obstacles() const { return soft_contact_.any(); }
  /// Of each soft obstacle on the span.
  [[nodiscard]] std::vector<Eigen::Vector3d> soft_obstacle_forces(const SpanPoint& at) const {
    return soft_contact_.forces(at.pressed);
  }
  /// What holds the rod on rigid obstacles by these multipliers.
  [[nodiscard]] std::vector<ContactForce> contact_forces(const SpanPoint& at,
                                                         const Eigen::VectorXd& multipliers) const {
    return contacts_.forces(at.contacts, at.t, of_contacts(multipliers));
  }

  /// Where one of Span::contacts that slides is; nothing of others.
  [[nodiscard]] std::optional<double> touches_at(const SpanPoint& at, std::size_t contact) const {
    return contacts_.touches_at(at.contacts, contact);
  }

  /// Torque of one of the span's holds and of the clamp at its start: the weak forms, from the
  /// directors' multipliers and from the balance about the start. They converge with the energy,
  /// the curvature at the very end only with its last coefficients.
  [[nodiscard]] Eigen::Vector3d hold_torque(SpanPoint& at, Eigen::Index hold,
                                            const Eigen::VectorXd& multipliers) const;
  [[nodiscard]] Eigen::Vector3d start_torque(SpanPoint& at,
                                             const Eigen::VectorXd& multipliers) const;

 private:
  [[nodiscard]] Eigen::Index strains() const { return unknowns_.strains(); }
  [[nodiscard]] bool has_psi() const { return unknowns_.has_psi; }
  void resize(SpanPoint& point) const;
  [[nodiscard]] PlanarPoint in_plane(SpanPoint& at) const { return {plane_, at.plane, at.t, at.x}; }
  [[nodiscard]] SpatialPoint in_space(SpanPoint& at) const {
    return {frames_, at.frames, at.t, has_psi() ? twist_root_ : 0, has_psi() ? twist(at.x) : 0};
  }
  /// Between those of positions and of directions.
  [[nodiscard]] Eigen::VectorXd of_contacts(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
    return multipliers.segment(grips_.positions(), contacts_.count());
  }
  void constrain(SpanPoint& point) const;
  void carry(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void carry_tilts(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void revise();

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

  PlanarFrames plane_;  // in the plane
  // In space
  Eigen::Matrix3d start_frame_ = Eigen::Matrix3d::Identity();
  RodFrames frames_;
  long revision_ = 0;
};

}  // namespace dlo::energy_model
