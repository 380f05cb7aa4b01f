#include "strain/span_energy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/legendre.hpp"
#include "base/spin.hpp"
#include "linear/free_directions.hpp"

namespace dlo::energy_model {
namespace {

/// Where a rod that nothing clamps may point at its start: what hangs there pulls it. Two
/// components of a turn lead from there to every direction but the opposite one, where they become
/// one.
Eigen::Vector3d first_tangent(const Span& span) {
  if (span.start_direction) return *span.start_direction;
  const Eigen::Vector3d before = span.force_before(span.anchor);
  return before.norm() > 0 ? Eigen::Vector3d(-before.normalized()) : Eigen::Vector3d::UnitX();
}

}  // namespace

void SpanEnergy::reset(const Span& span, int terms) {
  span_ = span;
  pieces_ = pieces_of(span);
  table_ = span.planar ? &legendre_table(terms) : &director_table(terms);
  tabulate_nodes(pieces_, *table_, s_, weights_);
  loads_.reset(span, s_, weights_);
  grips_.reset(span, pieces_, *table_);
  if (span.twist) twist_root_ = std::sqrt(span.twist->stiffness / span.length);
  contacts_.reset(span, pieces_, terms, *table_);
  soft_contact_.reset(span_, pieces_, *table_);
  for (Eigen::MatrixX3d* m : {&t_, &total_, &carried_}) m->setZero(s_.size(), 3);
  along_.setZero(s_.size());
  unknowns_ = {1, std::ssize(pieces_), terms, span.start_direction ? 0 : 1, false};
  if (span.planar) {
    std::optional<double> start_theta;
    if (span.start_direction) start_theta = angle_of(*span.start_direction);
    plane_.reset(pieces_, terms, start_theta, span.natural);
    plane_.resize(plane_state_);
    loads_.tabulate_couples(span, pieces_, plane_);
    grips_.reset_in_plane(plane_);
  } else {
    const Eigen::Vector3d tangent = first_tangent(span);
    start_frame_ = frame_along(tangent, span.first_d1(tangent));
    frames_.reset(pieces_, terms, start_frame_, !span.start_direction, span.natural);
    frames_.resize(state_);
    unknowns_.fields = frames_.fields();
    unknowns_.has_psi = span.twist && !span.has_material_directors();
    by_unknown_.resize(size());
    couples_.assign(pieces_.size(), Eigen::Vector3d::Zero());
    curvatures_.assign(pieces_.size(), Eigen::Matrix3d::Zero());
  }
  x_.setZero(size());
  gradient_.setZero(size());
  evaluated_ = false;
}

void SpanEnergy::turn_end_clamp(const Eigen::Vector3d& end_d1) {
  span_.twist->end_d1 = end_d1;
  grips_.turn_end_clamp(*span_.end_direction, end_d1);
}

double SpanEnergy::value(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> gradient) {
  if (evaluated_ && !has_soft_obstacles() && x == x_) {
    gradient = gradient_;
    return energy_;
  }
  x_ = x;
  if (span_.planar) {
    plane_.evaluate(x_, t_, plane_state_);
  } else {
    frames_.evaluate(x_, state_);
    t_ = state_.t.bottomRows(s_.size());
  }
  if (contacts_.count() > 0) contacts_.place(t_);
  gradient = x;
  unknowns_.clear_start(gradient);
  double energy = gradient.dot(x) / 2 + loads_.force_energy(t_);
  total_ = loads_.force();
  if (has_soft_obstacles()) energy += soft_contact_.add(t_, total_);
  if (span_.planar) {
    plane_.adjoint(total_, plane_state_);
    gradient -= plane_state_.by_unknown;
    if (loads_.couples().size() > 0) {
      energy -= loads_.couples().dot(x);
      gradient -= loads_.couples();
    }
  } else {
    frames_.add_adjoint({&total_}, -1, state_, gradient);
  }
  gradient_ = gradient;
  energy_ = energy;
  evaluated_ = true;
  return energy;
}

double SpanEnergy::twist(const Eigen::VectorXd& x) const {
  if (has_psi()) return x[x.size() - 1] / twist_root_;
  if (span_.planar || !span_.has_material_directors()) return 0;
  double angle = span_.natural.integral(span_.length).z();
  for (Eigen::Index e = 0; e < pieces(); ++e) {
    angle += piece(e).angle(2) * x[unknowns_.first(2, e)];
  }
  return angle;
}

double SpanEnergy::twisting_torque(const Eigen::VectorXd& x,
                                   const Eigen::VectorXd& multipliers) const {
  if (!span_.twist) return 0;
  // A turn of the clamp's d1 is all that its multiplier works on.
  return has_psi() ? twist(x) * twist_root_ * twist_root_ : multipliers[constraints() - 1];
}

Eigen::VectorXd SpanEnergy::with_twist(Eigen::VectorXd x, double angle) const {
  if (has_psi()) {
    x[x.size() - 1] = angle * twist_root_;
    return x;
  }
  // A torque is the same everywhere.
  double compliance = 0;
  for (const Piece& piece : pieces_) compliance += piece.length / piece.stiffness[2];
  const double torque = (angle - twist(x)) / compliance;
  for (Eigen::Index e = 0; e < pieces(); ++e) {
    x[unknowns_.first(2, e)] += torque * piece(e).angle(2);
  }
  return x;
}

void SpanEnergy::constraint(Eigen::Ref<Eigen::VectorXd> residual,
                            Eigen::Ref<Eigen::MatrixXd> jacobian) {
  const Eigen::Index count = contacts_.count();
  const Eigen::Index first = grips_.positions();
  if (count > 0) residual.segment(first, count) = contacts_.residual();
  if (span_.planar) {
    grips_.constrain(in_plane(), residual, jacobian);
    if (count == 0) return;
    jacobian.middleRows(first, count).noalias() =
        contacts_.along(plane_state_.t_theta).transpose() * plane_.by_unknown();
    return;
  }
  grips_.constrain(in_space(), residual, jacobian);
  for (Eigen::Index i = 0; i < count; ++i) {
    carried_ = contacts_.by_node(i);
    by_unknown_.setZero();
    frames_.add_adjoint({&carried_}, 1, state_, by_unknown_);
    jacobian.row(first + i) = by_unknown_.transpose();
  }
}

/// Into carried_: weight of the node times the force that the rod carries there with the grips'.
void SpanEnergy::carry(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  carried_ = total_;
  grips_.add_forces(multipliers, carried_);
  if (contacts_.count() > 0) contacts_.add(of_contacts(multipliers), carried_);
}

void SpanEnergy::hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                         Eigen::MatrixXd& result) {
  carry(multipliers);
  result.setIdentity(size(), size());
  auto stored = result.diagonal();
  unknowns_.clear_start(stored);
  if (span_.planar) {
    dot_in_plane(carried_, t_, along_);
    plane_.add_hessian(along_, plane_state_, result);
  } else {
    carried_ = -carried_;
    const SpatialPoint at = in_space();
    grips_.turn_derivatives(at, multipliers, couples_, curvatures_);
    frame_hessian_.add(frames_, {&carried_, couples_}, curvatures_, state_, result);
    if (has_psi()) grips_.add_twist_hessian(at, -multipliers[constraints() - 1], result);
  }
  if (!has_soft_obstacles() && !contacts_.curved()) return;
  const std::array<Eigen::MatrixXd, 3> tangents = tangent_jacobian();
  auto by_strains = result.topLeftCorner(strains(), strains());
  soft_contact_.add_hessian(tangents, by_strains);
  contacts_.subtract_hessian(of_contacts(multipliers), tangents, by_strains);
}

std::array<Eigen::MatrixXd, 3> SpanEnergy::tangent_jacobian() {
  return span_.planar ? plane_.tangent_jacobian(plane_state_) : frames_.tangent_jacobian(state_);
}

/// Into along_: weight of the node times n.t - B kappa^2, which is what the square of a tilt out of
/// the plane costs there.
void SpanEnergy::carry_tilts(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  carry(multipliers);
  dot_in_plane(carried_, t_, along_);
  plane_.subtract_bending(x_, weights_, plane_state_, along_);
}

bool SpanEnergy::resists_out_of_plane() {
  carry_tilts(Eigen::VectorXd());
  // int beta'^2 >= (pi / 2L)^2 int beta^2 for what a clamp holds at one end.
  const double bending = std::numbers::pi * std::numbers::pi / (4 * span_.length * span_.length);
  if (((along_.array() + bending * weights_.array()) > 0).all()) return true;
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(size(), size());
  plane_.add_hessian(along_, plane_state_, hessian);
  return is_minimum(hessian);
}

void SpanEnergy::tilt_hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                              Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) {
  carry_tilts(multipliers);
  hessian.setIdentity(size(), size());
  auto stored = hessian.diagonal();
  unknowns_.clear_start(stored);
  plane_.add_hessian(along_, plane_state_, hessian);
  const Eigen::MatrixXd& angle = plane_.by_unknown();
  if (contacts_.curved()) contacts_.subtract_tilt_hessian(of_contacts(multipliers), angle, hessian);
  if (has_soft_obstacles()) soft_contact_.add_tilt_hessian(angle, hessian);
  grips_.tilt_jacobian(plane_, jacobian);
}

SpanEnergy::Estimate SpanEnergy::estimate(const Eigen::Matrix3Xd& tangents) const {
  Estimate result;
  const Eigen::Index Q = table_->nodes.size();
  for (Eigen::Index q = 0; q + 1 < s_.size(); ++q) {
    // A jump between pieces is one that a fit has to smooth in some way of its
    // own.
    if ((q + 1) % Q == 0) continue;
    const double turned = (tangents.col(q + 1) - tangents.col(q)).squaredNorm();
    result.bending += turned / (2 * (s_[q + 1] - s_[q]));
  }
  result.energy = result.bending - loads_.force().transpose().cwiseProduct(tangents).sum();
  result.gap = grips_.gap(tangents);
  return result;
}

Eigen::VectorXd SpanEnergy::fit(const StartShape& shape, int most_steps) {
  if (!span_.planar) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size());
    evaluated_ = false;
    x.head(strains()) = energy_model::fit(frames_, shape.tangents, most_steps, state_);
    if (unknowns_.fields == 3 && shape.roll.size() > 0) x = rolled(frames_, x, shape.roll);
    return has_psi() ? with_twist(std::move(x), shape.twist) : x;
  }
  const Eigen::VectorXd angles = plane_.angles(shape.tangents);
  grips_.unwrap(angles, table_->nodes.size());
  return plane_.fit(angles);
}

void SpanEnergy::unwrap(const Eigen::Ref<const Eigen::VectorXd>& x) {
  if (span_.planar) grips_.unwrap(x, plane_.start_theta());
}

Eigen::VectorXd SpanEnergy::prolong(const SpanEnergy& other, const Eigen::VectorXd& x) {
  if (other.span_.planar && span_.planar) grips_.unwrap(other.grips_);
  // A planar shape's curvature is u1.
  Eigen::VectorXd prolonged = unknowns_.prolong(other.unknowns_, x);
  if (unknowns_.free_start == 1 && other.span_.planar && !span_.planar) {
    prolonged[0] = nearest_turn(x[0] - angle_of(start_frame_.col(2)), 0);
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
      contacts_.prolong(other.contacts_, other.of_contacts(multipliers));
  const Eigen::Index rest = grips_.directions();
  prolonged.tail(rest) = multipliers.tail(rest);
  return prolonged;
}

double SpanEnergy::longest_piece() const {
  double longest = 0;
  for (const Piece& piece : pieces_) longest = std::max(longest, piece.length);
  return longest;
}

double SpanEnergy::truncation(const Eigen::VectorXd& x, int terms) const {
  const Eigen::Index last = std::min(terms, 2);
  double largest = 0;
  for (Eigen::Index field = 0; field < unknowns_.fields; ++field) {
    for (Eigen::Index e = 0; e < pieces(); ++e) {
      const auto coefficients = x.segment(unknowns_.first(field, e) + terms - last, last);
      largest = std::max(largest, piece(e).angle(field) * coefficients.cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

SpanShape SpanEnergy::shape(const Eigen::VectorXd& x) const {
  SpanShape shape;
  shape.terms = terms();
  shape.planar = span_.planar;
  shape.anchor = span_.anchor;
  shape.pieces = pieces_;
  const Eigen::Index free_start = unknowns_.free_start;
  if (span_.planar) {
    shape.start_theta = plane_.start_theta() + (free_start == 1 ? x[0] : 0);
    shape.theta = x.tail(size() - free_start);
  } else {
    shape.start_frame = start_frame_;
    shape.free_start = free_start == 1;
    shape.strains = x.head(strains());
  }
  shape.natural = span_.natural;
  return shape;
}

TangentField SpanEnergy::field(const Eigen::VectorXd& x) const {
  const bool has_roll = !span_.planar && span_.has_material_directors();
  const double psi = has_psi() ? twist(x) : 0;
  return [shape = shape(x), has_roll, psi](const Eigen::VectorXd& s) {
    const SpanSamples samples = shape.sample({s.data(), static_cast<std::size_t>(s.size())});
    StartShape start(samples.tangents);
    if (has_roll) start.roll = roll_of(samples.tangents, samples.d1);
    start.twist = psi;
    return start;
  };
}

Energies SpanEnergy::energies(const Eigen::VectorXd& x) {
  Eigen::VectorXd gradient(x.size());
  (void)value(x, gradient);
  Energies energies;
  Eigen::VectorXd stored = x;
  unknowns_.clear_start(stored);
  const Eigen::Index bends = std::min<Eigen::Index>(unknowns_.fields, 2) * unknowns_.columns();
  energies.bending = stored.head(bends).squaredNorm() / 2;
  energies.twisting = stored.tail(stored.size() - bends).squaredNorm() / 2;
  if (!span_.loads.empty()) {
    energies.load = energy_of_forces(span_.loads, PositionOperator(span_, pieces_, *table_), t_);
  }
  energies.gravity = loads_.force_energy(t_) - energies.load;
  if (loads_.couples().size() > 0) energies.load -= loads_.couples().dot(x);
  for (const Span::Load& load : span_.loads) {
    if (!span_.planar || !span_.has_material_directors()) break;
    energies.load -= load.couple * span_.natural.integral(load.at).x();
  }
  energies.contact = soft_contact_.energy();
  return energies;
}

Eigen::Vector3d SpanEnergy::hold_torque(Eigen::Index hold, const Eigen::VectorXd& multipliers) {
  if (span_.planar) return grips_.torque(hold, multipliers, nullptr);
  const SpatialPoint at = in_space();
  return grips_.torque(hold, multipliers, &at);
}

Eigen::Vector3d SpanEnergy::start_torque(const Eigen::VectorXd& multipliers) {
  if (!span_.start_direction) return Eigen::Vector3d::Zero();
  const SpatialPoint at = in_space();
  Eigen::Vector3d moment = grips_.moment(multipliers, span_.planar ? nullptr : &at);
  loads_.add_moment(span_, t_, moment);
  if (contacts_.count() > 0) moment += contacts_.moment(of_contacts(multipliers), t_);
  return -(moment + soft_contact_.moment(t_));
}

}  // namespace dlo::energy_model
