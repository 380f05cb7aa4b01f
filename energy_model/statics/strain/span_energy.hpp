#pragma once

#include <Eigen/Core>
#include <array>
#include <tuple>
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

/// Energy of a span (strains, loads, soft obstacles) as a function of its unknowns, and its
/// constraints. The unknowns x in the plane are the tangent's angle at the start (if no clamp fixes
/// it) and the curvature coefficients of every element; in space they are those of RodFrames. The
/// energy of the strains is half the sum of the squares of the coefficients in both. If the end
/// frames of a rod without material directors are prescribed, the last unknown is the angle psi of
/// the rod's frame relative to Bishop's at the end, with whole turns, times (GJ / EI /
/// length)^(1/2): its square is twice the twist energy. psi rotates the end's frame to that of its
/// clamp. With material directors the frames are the rod's own.
///
/// L = E - sum mu . c: the multipliers mu are the forces (of positions) and torques (of directions)
/// that the grips exert on the rod, and those of ContactRows. Without obstacles evaluate() and
/// hessian() allocate nothing once a point has its size.
class SpanEnergy {
 public:
  /// Terms of the energy besides that of strains.
  using Terms = std::tuple<DeadLoads, SoftContact>;

  SpanEnergy() = default;
  SpanEnergy(const Span& span, int terms) { reset(span, terms); }
  /// Replaces the span; buffers of the same size are kept.
  void reset(const Span& span, int terms);

  [[nodiscard]] const Span& span() const { return span_; }
  /// Returns Span::total_load() of the span.
  [[nodiscard]] double load() const { return load_; }
  [[nodiscard]] Eigen::Index size() const { return unknowns_.size(); }
  [[nodiscard]] Eigen::Index constraints() const {
    return grips_.positions() + contacts_.count() + grips_.directions();
  }
  /// Returns the index of the first constraint on a direction; these constraints are the last ones.
  [[nodiscard]] Eigen::Index first_direction_row() const {
    return constraints() - grips_.directions();
  }
  [[nodiscard]] int terms() const { return static_cast<int>(unknowns_.terms); }
  [[nodiscard]] int elements() const { return static_cast<int>(elements_.size()); }

  /// Returns the identifier of the model's present values. It changes with reset() and
  /// turn_end_clamp(), and in the plane with fit() and prolong(), which set the clamps' angles.
  [[nodiscard]] long revision() const { return revision_; }
  /// Computes energy, gradient and constraints at x.
  void evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, SpanPoint& point) const;
  [[nodiscard]] SpanPoint evaluated(const Eigen::Ref<const Eigen::VectorXd>& x) const {
    SpanPoint point;
    evaluate(x, point);
    return point;
  }
  /// Computes the second derivatives of E - mu . c.
  void hessian(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
               Eigen::MatrixXd& result) const;
  /// Computes second derivatives for bending out of the plane, and the Jacobian of its constraints,
  /// for a planar span of a round rod without natural strains. The unknowns are the rates of the
  /// tangent's tilt. second_derivatives_out_of_plane() handles all planar spans.
  void tilt_hessian(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                    Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) const;
  /// Whether every bending out of the plane increases the energy; for a plain cantilever
  /// (Span::is_plain_cantilever()).
  [[nodiscard]] bool resists_out_of_plane(SpanPoint& at) const;

  /// Arc lengths of the nodes.
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return s_; }
  /// Returns the unknowns whose tangents (with material directors also frames) at the nodes come
  /// nearest to the given ones; a planar span ignores components out of its plane. The twist psi,
  /// if it is an unknown, is that of the shape. In the plane the clamps' angles are shifted to the
  /// winding of these tangents.
  /// @param most_steps  maximum number of fit steps in space, one evaluation each
  [[nodiscard]] Eigen::VectorXd fit(const StartShape& shape, int most_steps = most_fit_steps);

  /// Estimated energies of a shape given by tangents at the nodes, for a round rod that is
  /// uniform and intrinsically straight, and the distance by which it misses the grips; computed
  /// without a fit. The energies of couples and soft obstacles are not included.
  struct Estimate {
    double energy = 0;
    double bending = 0;  // part of `energy`
    double gap = 0;
  };
  [[nodiscard]] Estimate estimate(const Eigen::Matrix3Xd& tangents) const;

  /// Returns the unknowns of a shape that was found with another number of coefficients, or in the
  /// plane. In the plane the clamps' angles are shifted to the winding of this shape.
  [[nodiscard]] Eigen::VectorXd prolong(const SpanEnergy& other, const Eigen::VectorXd& x);

  [[nodiscard]] const SpanUnknowns& unknowns() const { return unknowns_; }

  /// Returns the multipliers of the same span's constraints that were found with another number of
  /// coefficients.
  [[nodiscard]] Eigen::VectorXd prolong_multipliers(const SpanEnergy& other,
                                                    const Eigen::VectorXd& multipliers) const;

  /// Returns the truncation indicator: upper bound of the rotation [rad] by one of the last two
  /// coefficients of any element; small if the curvature is resolved.
  [[nodiscard]] double truncation(const Eigen::VectorXd& x) const { return truncation(x, terms()); }
  /// Returns the truncation indicator of the first `terms` coefficients.
  [[nodiscard]] double truncation(const Eigen::VectorXd& x, int terms) const;
  /// Returns the twist: rotation of the end relative to the start [rad], natural twist included; 0
  /// for a span without unknowns of twist, which is planar or has no material directors and no end
  /// rotation.
  [[nodiscard]] double twist(const Eigen::VectorXd& x) const;
  /// Returns the torque of the clamp at the end about the tangent; 0 without prescribed end frames.
  [[nodiscard]] double twisting_torque(const Eigen::VectorXd& x,
                                       const Eigen::VectorXd& multipliers) const;
  /// Returns the unknowns with the given twist, for a span with unknowns of twist. Without psi a
  /// constant torque is added.
  [[nodiscard]] Eigen::VectorXd with_twist(Eigen::VectorXd x, double angle) const;
  /// Sets d1 of the clamp at the end, for a span with prescribed end frames.
  void turn_end_clamp(const Eigen::Vector3d& end_d1);

  [[nodiscard]] SpanShape shape(const Eigen::VectorXd& x) const;
  /// Returns the shape of these unknowns as an initial guess.
  [[nodiscard]] TangentField field(const Eigen::VectorXd& x) const;
  [[nodiscard]] Energies energies(const SpanPoint& at) const;

  [[nodiscard]] const Element& element(Eigen::Index index) const {
    return elements_[static_cast<std::size_t>(index)];
  }
  /// Legendre table that defines the nodes of each element.
  [[nodiscard]] const LegendreTable& table() const { return *table_; }
  /// Returns the derivatives of the tangents at the nodes by the unknowns except the twist psi:
  /// components x, y and z, nodes x unknowns.
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> tangent_jacobian(SpanPoint& at) const;

  [[nodiscard]] bool has_soft_obstacles() const { return !span_.soft_obstacles.empty(); }
  /// Returns the force of each soft obstacle on the span.
  [[nodiscard]] std::vector<Eigen::Vector3d> soft_obstacle_forces(const SpanPoint& at) const {
    return std::get<SoftContact>(terms_).forces(at);
  }
  /// Returns the forces of rigid obstacles on the rod for these multipliers.
  [[nodiscard]] std::vector<ContactForce> contact_forces(const SpanPoint& at,
                                                         const Eigen::VectorXd& multipliers) const {
    return contacts_.forces(at.contacts, at.t, contact_multipliers(multipliers));
  }

  /// Returns the arc length of one of Span::contacts if it slides; std::nullopt for other contacts.
  [[nodiscard]] std::optional<double> contact_arc_length(const SpanPoint& at,
                                                         std::size_t contact) const {
    return contacts_.contact_arc_length(at.contacts, contact);
  }

  /// hold_torque() returns the torque of one of the span's grips beyond the first, start_torque()
  /// that of the clamp at its start, 0 if there is none. Both are weak forms, from the directors'
  /// multipliers and from the moment balance about the start. They converge with the energy; the
  /// curvature at the very end converges only with its last coefficients.
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
  /// Returns the multipliers of contacts, which follow those of positions and precede those of
  /// directions.
  [[nodiscard]] Eigen::VectorXd contact_multipliers(
      const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
    return multipliers.segment(grips_.positions(), contacts_.count());
  }
  [[nodiscard]] TermSetup setup() const {
    return {span_, elements_, *table_, s_, weights_, plane_};
  }
  void constrain(SpanPoint& point) const;
  [[nodiscard]] bool is_curved() const;
  void add_curvature(const SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                     const std::array<Eigen::MatrixXd, 3>& tangents,
                     Eigen::Ref<Eigen::MatrixXd> hessian) const;
  void compute_carried_force(SpanPoint& at,
                             const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void compute_tilt_coefficients(SpanPoint& at,
                                 const Eigen::Ref<const Eigen::VectorXd>& multipliers) const;
  void unwrap(const Eigen::Ref<const Eigen::VectorXd>& x);
  void update_revision();

  Span span_;
  double load_ = 0;
  std::vector<Element> elements_;
  SpanUnknowns unknowns_;
  double twist_root_ = 0;  // derivative of the last unknown by the twist
  const LegendreTable* table_ = nullptr;
  Eigen::VectorXd s_, weights_;

  Terms terms_;
  GripRows grips_;
  ContactRows contacts_;

  PlanarFrames plane_;  // in the plane
  // In space
  Eigen::Matrix3d start_frame_ = Eigen::Matrix3d::Identity();
  RodFrames frames_;
  long revision_ = 0;
};

}  // namespace dlo::energy_model
