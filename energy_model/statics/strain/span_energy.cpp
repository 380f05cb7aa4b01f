#include "strain/span_energy.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/legendre.hpp"
#include "base/spin.hpp"
#include "linear/reduced_hessian.hpp"

namespace dlo::energy_model {
namespace {

/// Returns the direction of a clamp at the start; without a clamp, a direction opposite to the
/// force on the part of the span before the anchor, or x if that force is zero. From that direction
/// the two components of the start's rotation reach every direction; they become dependent only at
/// the opposite direction.
Eigen::Vector3d first_tangent(const Span& span) {
  if (span.start_direction) return *span.start_direction;
  const Eigen::Vector3d before = span.force_before(span.anchor);
  return before.norm() > 0 ? Eigen::Vector3d(-before.normalized()) : Eigen::Vector3d::UnitX();
}

template <typename Terms, typename Function>
void for_each(Terms& terms, const Function& function) {
  std::apply([&](auto&... term) { (function(term), ...); }, terms);
}

}  // namespace

void SpanEnergy::reset(const Span& span, int terms) {
  span_ = span;
  load_ = span.total_load();
  elements_ = elements_of(span);
  table_ = span.planar ? &legendre_table(terms) : &director_table(terms);
  tabulate_nodes(elements_, *table_, s_, weights_);
  grips_.reset(span, elements_, *table_);
  if (span.twist) twist_root_ = std::sqrt(span.twist->stiffness / span.length);
  contacts_.reset(span, elements_, terms, *table_);
  unknowns_ = {1, std::ssize(elements_), terms, span.start_direction ? 0 : 1, false};
  if (span.planar) {
    std::optional<double> start_theta;
    if (span.start_direction) start_theta = angle_of(*span.start_direction);
    plane_.reset(elements_, terms, start_theta, span.natural);
    grips_.reset_in_plane(plane_);
  } else {
    const Eigen::Vector3d tangent = first_tangent(span);
    start_frame_ = frame_along(tangent, span.first_d1(tangent));
    frames_.reset(elements_, terms, start_frame_, !span.start_direction, span.natural);
    unknowns_.fields = frames_.fields();
    unknowns_.has_psi = span.twist && !span.has_material_directors();
  }
  for_each(terms_, [this](auto& term) { term.reset(setup()); });
  update_revision();
}

void SpanEnergy::update_revision() {
  static std::atomic<long> last = 0;
  revision_ = ++last;
}

void SpanEnergy::resize(SpanPoint& point) const {
  for (Eigen::VectorXd* v : {&point.x, &point.gradient, &point.by_unknown}) v->resize(size());
  point.residual.resize(constraints());
  point.jacobian.resize(constraints(), size());
  for (Eigen::MatrixX3d* m : {&point.t, &point.force, &point.carried}) m->setZero(s_.size(), 3);
  point.along.resize(s_.size());
  if (span_.planar) {
    plane_.resize(point.plane);
  } else {
    frames_.resize(point.frames);
    point.couples.resize(elements_.size());
    point.curvatures.resize(elements_.size());
  }
  contacts_.resize(point.contacts);
  point.revision = revision_;
}

void SpanEnergy::turn_end_clamp(const Eigen::Vector3d& end_d1) {
  span_.twist->end_d1 = end_d1;
  grips_.turn_end_clamp(*span_.end_direction, end_d1);
  update_revision();
}

void SpanEnergy::evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, SpanPoint& point) const {
  if (point.revision != revision_) resize(point);
  point.x = x;
  if (span_.planar) {
    plane_.evaluate(x, point.t, point.plane);
  } else {
    frames_.evaluate(x, point.frames);
    point.t = point.frames.t.bottomRows(s_.size());
  }
  point.gradient = x;
  unknowns_.clear_start(point.gradient);
  point.energy = point.gradient.dot(x) / 2;
  point.force.setZero();
  for_each(terms_, [&](const auto& term) { term.evaluate(point); });
  if (span_.planar) {
    plane_.adjoint(point.force, point.plane);
    point.gradient -= point.plane.by_unknown;
  } else {
    frames_.add_adjoint({&point.force}, -1, point.frames, point.gradient);
  }
  if (constraints() > 0) constrain(point);
}

double SpanEnergy::twist(const Eigen::VectorXd& x) const {
  if (has_psi()) return x[x.size() - 1] / twist_root_;
  if (span_.planar || !span_.has_material_directors()) return 0;
  double angle = span_.natural.integral(span_.length).z();
  for (Eigen::Index e = 0; e < elements(); ++e) {
    angle += element(e).angle(2) * x[unknowns_.first(2, e)];
  }
  return angle;
}

double SpanEnergy::twisting_torque(const Eigen::VectorXd& x,
                                   const Eigen::VectorXd& multipliers) const {
  if (!span_.twist) return 0;
  // The multiplier of the clamp's d1 does work only on a rotation of that d1.
  return has_psi() ? twist(x) * twist_root_ * twist_root_ : multipliers[constraints() - 1];
}

Eigen::VectorXd SpanEnergy::with_twist(Eigen::VectorXd x, double angle) const {
  if (has_psi()) {
    x[x.size() - 1] = angle * twist_root_;
    return x;
  }
  // A torque that is constant along the span changes the strains by its quotient with the
  // stiffness.
  double compliance = 0;
  for (const Element& element : elements_) compliance += element.length / element.stiffness[2];
  const double torque = (angle - twist(x)) / compliance;
  for (Eigen::Index e = 0; e < elements(); ++e) {
    x[unknowns_.first(2, e)] += torque * element(e).angle(2);
  }
  return x;
}

void SpanEnergy::constrain(SpanPoint& point) const {
  const Eigen::Index count = contacts_.count();
  const Eigen::Index first = grips_.positions();
  if (count > 0) {
    contacts_.evaluate(point.t, point.contacts);
    point.residual.segment(first, count) = point.contacts.residual;
  }
  if (span_.planar) {
    grips_.constrain(in_plane(point), point.residual, point.jacobian);
    if (count == 0) return;
    point.jacobian.middleRows(first, count).noalias() =
        point.contacts.along(point.plane.t_theta).transpose() * plane_.by_unknown();
    return;
  }
  grips_.constrain(in_space(point), point.residual, point.jacobian);
  const std::array<Eigen::MatrixXd, 3>& by_tangent = point.contacts.by_tangent;
  for (Eigen::Index i = 0; i < count; ++i) {
    point.carried << by_tangent[0].col(i), by_tangent[1].col(i), by_tangent[2].col(i);
    point.by_unknown.setZero();
    frames_.add_adjoint({&point.carried}, 1, point.frames, point.by_unknown);
    point.jacobian.row(first + i) = point.by_unknown.transpose();
  }
}

/// Computes at.carried: quadrature weight of the node times the force that the rod carries there,
/// including the forces of grips and contacts.
void SpanEnergy::compute_carried_force(SpanPoint& at,
                                       const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  at.carried = at.force;
  grips_.add_forces(multipliers, at.carried);
  if (contacts_.count() > 0) at.contacts.add(contact_multipliers(multipliers), at.carried);
}

void SpanEnergy::hessian(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                         Eigen::MatrixXd& result) const {
  compute_carried_force(at, multipliers);
  result.setIdentity(size(), size());
  auto stored = result.diagonal();
  unknowns_.clear_start(stored);
  if (span_.planar) {
    dot_in_plane(at.carried, at.t, at.along);
    plane_.add_hessian(at.along, at.plane, result);
  } else {
    at.carried = -at.carried;
    const SpatialPoint here = in_space(at);
    grips_.rotation_derivatives(here, multipliers, at.couples, at.curvatures);
    at.frame_hessian.add(frames_, {&at.carried, at.couples}, at.curvatures, at.frames, result);
    if (has_psi()) grips_.add_twist_hessian(here, -multipliers[constraints() - 1], result);
  }
  if (!is_curved()) return;
  add_curvature(at, multipliers, tangent_jacobian(at), result.topLeftCorner(strains(), strains()));
}

/// Whether terms or constraints are nonlinear in the tangents.
bool SpanEnergy::is_curved() const {
  bool curved = contacts_.curved();
  for_each(terms_, [&](const auto& term) { curved = curved || term.is_curved(); });
  return curved;
}

/// Adds the part of the Hessian that does not contain second derivatives of the tangents.
void SpanEnergy::add_curvature(const SpanPoint& at,
                               const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                               const std::array<Eigen::MatrixXd, 3>& tangents,
                               Eigen::Ref<Eigen::MatrixXd> hessian) const {
  for_each(terms_, [&](const auto& term) { term.add_hessian(at, tangents, hessian); });
  contacts_.subtract_hessian(at.contacts, contact_multipliers(multipliers), tangents, hessian);
}

std::array<Eigen::MatrixXd, 3> SpanEnergy::tangent_jacobian(SpanPoint& at) const {
  return span_.planar ? plane_.tangent_jacobian(at.plane) : frames_.tangent_jacobian(at.frames);
}

/// Computes at.along: the quadrature weight of the node, multiplied by (n.t - B kappa^2). This is
/// the coefficient of a squared tilt out of the plane in the second variation.
void SpanEnergy::compute_tilt_coefficients(
    SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  compute_carried_force(at, multipliers);
  dot_in_plane(at.carried, at.t, at.along);
  plane_.subtract_bending(at.x, weights_, at.plane, at.along);
}

bool SpanEnergy::resists_out_of_plane(SpanPoint& at) const {
  compute_tilt_coefficients(at, Eigen::VectorXd());
  // int beta'^2 >= (pi / 2L)^2 int beta^2, as a clamp fixes beta at one end.
  const double bending = std::numbers::pi * std::numbers::pi / (4 * span_.length * span_.length);
  if (((at.along.array() + bending * weights_.array()) > 0).all()) return true;
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(size(), size());
  plane_.add_hessian(at.along, at.plane, hessian);
  return is_minimum(hessian);
}

void SpanEnergy::tilt_hessian(SpanPoint& at, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                              Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) const {
  compute_tilt_coefficients(at, multipliers);
  hessian.setIdentity(size(), size());
  auto stored = hessian.diagonal();
  unknowns_.clear_start(stored);
  plane_.add_hessian(at.along, at.plane, hessian);
  const Eigen::MatrixXd& angle = plane_.by_unknown();
  if (is_curved()) {
    const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(angle.rows(), angle.cols());
    add_curvature(at, multipliers, {none, none, angle}, hessian);
  }
  grips_.tilt_jacobian(plane_, jacobian);
}

SpanEnergy::Estimate SpanEnergy::estimate(const Eigen::Matrix3Xd& tangents) const {
  Estimate result;
  const Eigen::Index Q = table_->nodes.size();
  for (Eigen::Index q = 0; q + 1 < s_.size(); ++q) {
    // A jump between elements does not count: the fit smooths it.
    if ((q + 1) % Q == 0) continue;
    const double turned = (tangents.col(q + 1) - tangents.col(q)).squaredNorm();
    result.bending += turned / (2 * (s_[q + 1] - s_[q]));
  }
  result.energy =
      result.bending - std::get<DeadLoads>(terms_).force().transpose().cwiseProduct(tangents).sum();
  result.gap = grips_.gap(tangents);
  return result;
}

Eigen::VectorXd SpanEnergy::fit(const StartShape& shape, int most_steps) {
  if (!span_.planar) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size());
    RodFrames::State state;
    frames_.resize(state);
    x.head(strains()) = energy_model::fit(frames_, shape.tangents, most_steps, state);
    if (unknowns_.fields == 3 && shape.roll.size() > 0) x = rolled(frames_, x, shape.roll);
    return has_psi() ? with_twist(std::move(x), shape.twist) : x;
  }
  Eigen::VectorXd x = plane_.fit(plane_.angles(shape.tangents));
  unwrap(x);
  return x;
}

/// Shifts the clamps' angles by multiples of 2 pi to the winding of these unknowns, in the plane.
void SpanEnergy::unwrap(const Eigen::Ref<const Eigen::VectorXd>& x) {
  grips_.unwrap(x, plane_.start_theta());
  update_revision();
}

Eigen::VectorXd SpanEnergy::prolong(const SpanEnergy& other, const Eigen::VectorXd& x) {
  // The curvature of a planar shape is u1.
  Eigen::VectorXd prolonged = unknowns_.prolong(other.unknowns_, x);
  if (span_.planar) unwrap(prolonged);
  if (unknowns_.free_start == 1 && other.span_.planar && !span_.planar) {
    prolonged[0] = nearest_equivalent_angle(x[0] - angle_of(start_frame_.col(2)), 0);
  }
  return prolonged;
}

Eigen::VectorXd SpanEnergy::prolong_multipliers(const SpanEnergy& other,
                                                const Eigen::VectorXd& multipliers) const {
  if (contacts_.count() == other.contacts_.count()) return multipliers;
  Eigen::VectorXd prolonged(constraints());
  const Eigen::Index first = grips_.positions();
  prolonged.head(first) = multipliers.head(first);
  prolonged.segment(first, contacts_.count()) =
      contacts_.prolong(other.contacts_, other.contact_multipliers(multipliers));
  const Eigen::Index rest = grips_.directions();
  prolonged.tail(rest) = multipliers.tail(rest);
  return prolonged;
}

double SpanEnergy::truncation(const Eigen::VectorXd& x, int terms) const {
  const Eigen::Index last = std::min(terms, 2);
  double largest = 0;
  for (Eigen::Index field = 0; field < unknowns_.fields; ++field) {
    for (Eigen::Index e = 0; e < elements(); ++e) {
      const auto coefficients = x.segment(unknowns_.first(field, e) + terms - last, last);
      largest = std::max(largest, element(e).angle(field) * coefficients.cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

SpanShape SpanEnergy::shape(const Eigen::VectorXd& x) const {
  SpanShape shape;
  shape.terms = terms();
  shape.planar = span_.planar;
  shape.anchor = span_.anchor;
  shape.elements = elements_;
  shape.free_start = unknowns_.free_start == 1;
  if (span_.planar) shape.start_theta = plane_.start_theta() + (shape.free_start ? x[0] : 0);
  shape.start_frame = start_frame_;
  shape.strains = x.head(strains());
  shape.natural = span_.natural;
  return shape;
}

TangentField SpanEnergy::field(const Eigen::VectorXd& x) const {
  const bool has_roll = !span_.planar && span_.has_material_directors();
  const double psi = has_psi() ? twist(x) : 0;
  return [shape = shape(x), has_roll, psi](const Eigen::VectorXd& s) {
    const Samples samples = shape.sample({s.data(), static_cast<std::size_t>(s.size())});
    StartShape start(samples.tangents);
    if (has_roll) start.roll = roll_of(samples.tangents, samples.d1);
    start.twist = psi;
    return start;
  };
}

Energies SpanEnergy::energies(const SpanPoint& at) const {
  Energies energies;
  Eigen::VectorXd stored = at.x;
  unknowns_.clear_start(stored);
  const Eigen::Index bends = std::min<Eigen::Index>(unknowns_.fields, 2) * unknowns_.columns();
  energies.bending = stored.head(bends).squaredNorm() / 2;
  energies.twisting = stored.tail(stored.size() - bends).squaredNorm() / 2;
  for_each(terms_, [&](const auto& term) { term.add_energies(setup(), at, energies); });
  return energies;
}

Eigen::Vector3d SpanEnergy::hold_torque(SpanPoint& at, Eigen::Index hold,
                                        const Eigen::VectorXd& multipliers) const {
  if (span_.planar) return grips_.torque(hold, multipliers, nullptr);
  const SpatialPoint here = in_space(at);
  return grips_.torque(hold, multipliers, &here);
}

Eigen::Vector3d SpanEnergy::start_torque(SpanPoint& at, const Eigen::VectorXd& multipliers) const {
  if (!span_.start_direction) return Eigen::Vector3d::Zero();
  compute_carried_force(at, multipliers);
  Eigen::Vector3d moment = moment_about_anchor(at.t, at.carried);
  if (span_.planar) moment.head<2>().setZero();
  for_each(terms_, [&](const auto& term) { term.add_couples(moment); });
  for (Eigen::Index j = 0; j < std::ssize(span_.holds); ++j) {
    moment += hold_torque(at, j, multipliers);
  }
  return -moment;
}

}  // namespace dlo::energy_model
