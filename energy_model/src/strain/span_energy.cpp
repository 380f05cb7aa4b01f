#include "strain/span_energy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/fit_angle.hpp"
#include "base/legendre.hpp"
#include "base/spin.hpp"
#include "linear/dense_products.hpp"
#include "linear/free_directions.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

double angle_of(const Eigen::Vector3d& direction) {
  return std::atan2(direction.y(), direction.x());
}

/// A frame whose third column is this tangent; a planar shape then bends by u1 alone.
Eigen::Matrix3d default_frame(const Eigen::Vector3d& tangent) {
  return frame_along(tangent, Span::d1(tangent));
}

/// Where a rod that nothing clamps may point at its start: what hangs there pulls it. Two
/// components of a turn lead from there to every direction but the opposite one, where they become
/// one.
Eigen::Vector3d first_tangent(const Span& span) {
  if (span.start_direction) return *span.start_direction;
  const Eigen::Vector3d before = span.force_before(span.anchor);
  return before.norm() > 0 ? Eigen::Vector3d(-before.normalized()) : Eigen::Vector3d::UnitX();
}

/// Products, node by node, of two vectors in the plane x-y.
void dot_in_plane(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b, Eigen::VectorXd& result) {
  result = a.col(0).cwiseProduct(b.col(0)) + a.col(1).cwiseProduct(b.col(1));
}

/// The angle that differs from `angle` by whole turns and is nearest to `target`.
double nearest_turn(double angle, double target) {
  return angle + 2 * pi * std::round((target - angle) / (2 * pi));
}

}  // namespace

void SpanEnergy::tabulate_angles() {
  const Eigen::Index Q = table_->nodes.size();
  const Eigen::Index K = terms_;
  const auto count = static_cast<Eigen::Index>(pieces_.size());
  angle_.setZero(s_.size(), columns_);
  held_angle_.setZero(static_cast<Eigen::Index>(director_rows_.size()), columns_);
  if (free_start_ == 1) {
    angle_.col(0).setOnes();
    held_angle_.col(0).setOnes();
  }
  for (Eigen::Index e = 0; e < count; ++e) {
    const double turn = pieces_[static_cast<std::size_t>(e)].angle(0);
    const Eigen::Index column = free_start_ + e * K;
    angle_.block(e * Q, column, Q, K) = turn * table_->integrals.leftCols(K);
    // Only p_0 turns the tangent over a whole piece.
    angle_.col(column).tail((count - e - 1) * Q).setConstant(turn);
    for (std::size_t i = 0; i < director_rows_.size(); ++i) {
      if (e <= director_rows_[i].piece) held_angle_(static_cast<Eigen::Index>(i), column) = turn;
    }
  }
  angle_transposed_ = angle_.transpose();
}

/// Of the nodes of the stress-free shape.
void SpanEnergy::tabulate_natural_angles() {
  natural_angle_.resize(0);
  if (!span_.has_material_directors()) return;
  natural_angle_.resize(s_.size());
  for (Eigen::Index q = 0; q < s_.size(); ++q) {
    natural_angle_[q] = span_.natural.integral(s_[q]).x();
  }
}

void SpanEnergy::tabulate_couples() {
  couples_work_.resize(0);
  if (!span_.has_couples()) return;
  couples_work_.setZero(columns_);
  for (const Span::Load& load : span_.loads) {
    if (free_start_ == 1) couples_work_[0] += load.couple;
    for (Eigen::Index e = 0; e < pieces_before(pieces_, load.at); ++e) {
      couples_work_[free_start_ + e * terms_] += load.couple * piece(e).angle(0);
    }
  }
}

void SpanEnergy::tabulate_forces() {
  const Eigen::Index nodes = s_.size();
  force_.resize(nodes, 3);
  for (Eigen::Index q = 0; q < nodes; ++q) {
    // What hangs beyond a node, seen from the anchor.
    const bool after = s_[q] > span_.anchor;
    Eigen::Vector3d n = span_.weight_between(s_[q], after ? span_.length : 0);
    for (const Span::Load& load : span_.loads) {
      if (after && load.at > s_[q]) n += load.force;
      if (!after && load.at < s_[q]) n -= load.force;
    }
    force_.row(q) = weights_[q] * n.transpose();
  }
  reach_.resize(nodes, std::ssize(span_.holds));
  reach_signs_.clear();
  if (span_.holds.empty()) return;
  const PositionOperator reach(span_, pieces_, *table_);
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const double at = span_.holds[static_cast<std::size_t>(j)].at;
    reach_.col(j) = reach.begin(pieces_before(pieces_, at));
    reach_signs_.push_back(reach.signs(at));
  }
}

void SpanEnergy::reset(const Span& span, int terms) {
  std::vector<Piece> pieces = pieces_of(span);
  // Of a cantilever in the plane angles depend on the pieces alone.
  const auto is_cantilever = [](const Span& of) {
    return of.planar && of.start_direction && of.holds.empty();
  };
  const auto is_same = [](const Piece& a, const Piece& b) {
    return a.begin == b.begin && a.length == b.length && a.stiffness == b.stiffness;
  };
  const bool has_angles =
      angle_.size() > 0 && is_cantilever(span) && is_cantilever(span_) && terms == terms_ &&
      std::equal(pieces.begin(), pieces.end(), pieces_.begin(), pieces_.end(), is_same);
  span_ = span;
  terms_ = terms;
  axes_ = span.planar ? 2 : 3;
  free_start_ = span.start_direction ? 0 : 1;
  pieces_ = std::move(pieces);
  if (!has_angles) {
    table_ = span.planar ? &legendre_table(terms) : &director_table(terms);
    columns_ = free_start_ + std::ssize(pieces_) * terms;
    tabulate_nodes(pieces_, *table_, s_, weights_);
  }
  tabulate_forces();
  if (span.twist) twist_root_ = std::sqrt(span.twist->stiffness / span.length);
  contacts_.reset(span, pieces_, terms, *table_);
  list_director_rows();
  constraints_ = first_director_row() + static_cast<Eigen::Index>(director_rows_.size());
  const Eigen::Index nodes = s_.size();
  for (Eigen::MatrixX3d* m : {&t_, &t_theta_, &total_, &carried_}) m->setZero(nodes, 3);
  if (span.planar) {
    if (!has_angles) tabulate_angles();
    tabulate_natural_angles();
    tabulate_couples();
    start_theta_ = span.start_direction ? angle_of(*span.start_direction) : 0;
    for (DirectorRow& row : director_rows_) {
      row.angle = nearest_turn(angle_of(row.to), start_theta_) - natural_turn(row.piece);
    }
    for (Eigen::VectorXd* v : {&theta_, &kappa_, &along_, &turning_}) v->setZero(nodes);
    scaled_.resize(terms_, table_->nodes.size());
    own_.resize(terms_, terms_);
    beside_.resize(terms_);
    pulled_.resize(columns_);
  } else {
    const Eigen::Vector3d tangent = first_tangent(span);
    start_frame_ = frame_along(tangent, span.first_d1(tangent));
    frames_.reset(pieces_, terms, start_frame_, free_start_ == 1, span_.natural);
    frames_.resize(state_);
    pulled_.resize(size());
    couples_.assign(pieces_.size(), Eigen::Vector3d::Zero());
    curvatures_.assign(pieces_.size(), Eigen::Matrix3d::Zero());
  }
  x_.setZero(size());
  gradient_.setZero(size());
  evaluated_ = false;
  soft_contact_.reset(span_, pieces_, *table_);
}

/// The directions of the clamps inside the span and at its end; there of d1 too if it is held.
void SpanEnergy::list_director_rows() {
  director_rows_.clear();
  const auto add = [&](Eigen::Index hold, Eigen::Index piece, const Eigen::Vector3d& to) {
    const Eigen::Matrix3d frame = default_frame(to);
    director_rows_.push_back({hold, piece, to, frame.col(0)});
    if (!span_.planar) director_rows_.push_back({hold, piece, to, frame.col(1)});
  };
  const auto holds = static_cast<Eigen::Index>(span_.holds.size());
  for (Eigen::Index j = 0; j < holds; ++j) {
    const Span::Hold& hold = span_.holds[static_cast<std::size_t>(j)];
    if (!hold.direction) continue;
    add(j, pieces_before(pieces_, hold.at) - 1, *hold.direction);
  }
  if (!span_.end_direction) return;
  add(holds - 1, pieces() - 1, *span_.end_direction);
  if (!span_.twist) return;
  director_rows_.push_back(
      {holds - 1, pieces() - 1, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), true});
  turn_end_clamp(span_.twist->end_d1);
}

void SpanEnergy::turn_end_clamp(const Eigen::Vector3d& end_d1) {
  span_.twist->end_d1 = end_d1;
  const Eigen::Matrix3d held = frame_along(*span_.end_direction, end_d1);
  director_rows_.back().to = held.col(0);
  director_rows_.back().across = held.col(1);
}

/// Into t_ (and t_theta_ in the plane), at x_.
void SpanEnergy::place_tangents() {
  if (!span_.planar) {
    frames_.evaluate(x_, state_);
    t_ = state_.t.bottomRows(s_.size());
    return;
  }
  multiply(angle_, x_, theta_);
  theta_.array() += start_theta_;
  if (natural_angle_.size() > 0) theta_ += natural_angle_;
  dense_kernel().turn(theta_.data(), theta_.size(), t_.col(0).data(), t_.col(1).data());
  t_theta_.col(0) = -t_.col(1);
  t_theta_.col(1) = t_.col(0);
}

double SpanEnergy::value(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> gradient) {
  if (evaluated_ && !has_soft_obstacles() && x == x_) {
    gradient = gradient_;
    return energy_;
  }
  x_ = x;
  place_tangents();
  if (contacts_.count() > 0) contacts_.place(t_);
  gradient = x;
  // A free start has a rigid-body mode.
  for (Eigen::Index f = 0; f < fields() && free_start_ == 1; ++f) gradient[f * columns_] = 0;
  double energy = gradient.dot(x) / 2 - force_.cwiseProduct(t_).sum();
  total_ = force_;
  if (has_soft_obstacles()) energy += soft_contact_.add(t_, total_);
  if (span_.planar) {
    dot_in_plane(total_, t_theta_, turning_);
    multiply(angle_transposed_, turning_, pulled_);
    gradient -= pulled_;
    if (couples_work_.size() > 0) {
      energy -= couples_work_.dot(x);
      gradient -= couples_work_;
    }
  } else {
    frames_.pull({&total_}, -1, state_, gradient);
  }
  gradient_ = gradient;
  energy_ = energy;
  evaluated_ = true;
  return energy;
}

DirectionResidual SpanEnergy::residual_of(const DirectorRow& row) const {
  const Eigen::Matrix3d frame = frames_.frame_after(state_, row.piece);
  if (!row.of_d1) return direction_residual(frame.col(2), row.to, row.across);
  const double psi = has_psi() ? twist(x_) : 0;
  const Eigen::Vector3d d1 = std::cos(psi) * frame.col(0) + std::sin(psi) * frame.col(1);
  return direction_residual(d1, row.to, row.across);
}

double SpanEnergy::twist(const Eigen::VectorXd& x) const {
  if (has_psi()) return x[x.size() - 1] / twist_root_;
  if (span_.planar || !span_.has_material_directors()) return 0;
  double angle = span_.natural.integral(span_.length).z();
  for (Eigen::Index e = 0; e < pieces(); ++e) {
    angle += pieces_[static_cast<std::size_t>(e)].angle(2) * x[first_twist(e)];
  }
  return angle;
}

double SpanEnergy::twisting_torque(const Eigen::VectorXd& x,
                                   const Eigen::VectorXd& multipliers) const {
  if (!span_.twist) return 0;
  // A turn of the clamp's d1 is all that its multiplier works on.
  return has_psi() ? twist(x) * twist_root_ * twist_root_ : multipliers[constraints_ - 1];
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
    x[first_twist(e)] += torque * pieces_[static_cast<std::size_t>(e)].angle(2);
  }
  return x;
}

void SpanEnergy::constraint(Eigen::Ref<Eigen::VectorXd> residual,
                            Eigen::Ref<Eigen::MatrixXd> jacobian) {
  Eigen::Index row = 0;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis) {
      residual[row + axis] =
          t_.col(axis).dot(reach_.col(j)) - span_.holds[static_cast<std::size_t>(j)].offset[axis];
      if (!span_.planar) continue;
      turning_ = t_theta_.col(axis).cwiseProduct(reach_.col(j));
      multiply(angle_transposed_, turning_, pulled_);
      jacobian.row(row + axis) = pulled_.transpose();
    }
    if (!span_.planar) {
      frames_.pull_position(reach_signs_[static_cast<std::size_t>(j)], state_,
                            jacobian.middleRows(row, 3));
      if (has_psi()) jacobian.col(strains()).segment<3>(row).setZero();
    }
    row += axes_;
  }
  if (contacts_.count() > 0) {
    residual.segment(row, contacts_.count()) = contacts_.residual();
    if (span_.planar) {
      jacobian.middleRows(row, contacts_.count()).noalias() =
          contacts_.along(t_theta_).transpose() * angle_;
    }
  }
  for (Eigen::Index i = 0; i < contacts_.count() && !span_.planar; ++i) {
    carried_ = contacts_.by_node(i);
    pulled_.setZero();
    frames_.pull({&carried_}, 1, state_, pulled_);
    jacobian.row(row + i) = pulled_.transpose();
  }
  row += contacts_.count();
  if (span_.planar) {
    if (director_rows_.empty()) return;
    jacobian.bottomRows(held_angle_.rows()) = held_angle_;
    residual.tail(held_angle_.rows()).noalias() = held_angle_ * x_;
    for (const DirectorRow& held : director_rows_) {
      residual[row++] += start_theta_ - held.angle;
    }
    return;
  }
  if (!director_rows_.empty()) frames_.end_rotation_jacobian(state_);
  for (const DirectorRow& held : director_rows_) {
    const DirectionResidual held_residual = residual_of(held);
    residual[row] = held_residual.value;
    frames_.pull_couple(held.piece, held_residual.couple, state_,
                        jacobian.row(row).head(strains()));
    // Twist turns d1 about the tangent.
    if (has_psi()) {
      jacobian(row, strains()) =
          held.of_d1 ? held_residual.couple.dot(state_.end_frame().col(2)) / twist_root_ : 0;
    }
    ++row;
  }
}

double SpanEnergy::natural_turn(Eigen::Index piece) const {
  if (!span_.has_material_directors()) return 0;
  return span_.natural.integral(pieces_[static_cast<std::size_t>(piece)].end()).x();
}

/// Adds the second derivatives of sum along_ angle^2 / 2. Beyond its own piece an unknown turns the
/// rod as a whole, if it is the first of its piece or the start's angle, or not at all.
void SpanEnergy::add_angles_squared(Eigen::Ref<Eigen::MatrixXd> result) {
  const Eigen::Index Q = table_->nodes.size();
  const Eigen::Index K = terms_;
  double later = 0;
  for (Eigen::Index e = pieces(); e-- > 0;) {
    const auto along = along_.segment(e * Q, Q);
    const double own_turn = pieces_[static_cast<std::size_t>(e)].angle(0);
    const Eigen::Index column = free_start_ + e * K;
    const auto angle = angle_transposed_.block(column, e * Q, K, Q);
    scaled_ = angle * along.asDiagonal();
    multiply_symmetric(angle, scaled_, own_);
    result.block(column, column, K, K) += own_;
    result(column, column) += own_turn * own_turn * later;
    if (column > 0) multiply(angle, along, beside_);
    beside_[0] += own_turn * later;
    for (Eigen::Index before = -free_start_; before < e; ++before) {
      const bool start = before < 0;
      const double turn = start ? 1 : pieces_[static_cast<std::size_t>(before)].angle(0);
      const Eigen::Index row = start ? 0 : free_start_ + before * K;
      result.row(row).segment(column, K) += turn * beside_.transpose();
      result.col(row).segment(column, K) += turn * beside_;
    }
    later += along.sum();
  }
  if (free_start_ == 1) result(0, 0) += later;
}

/// Into carried_: weight of the node times the force that the rod carries there with the grips'.
void SpanEnergy::carry(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  carried_ = total_;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis) {
      carried_.col(axis) += multipliers[j * axes_ + axis] * reach_.col(j);
    }
  }
  if (contacts_.count() == 0) return;
  contacts_.add(multipliers.segment(first_contact_row(), contacts_.count()), carried_);
}

void SpanEnergy::hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                         Eigen::MatrixXd& result) {
  carry(multipliers);
  result.setIdentity(size(), size());
  for (Eigen::Index f = 0; f < fields() && free_start_ == 1; ++f) {
    result(f * columns_, f * columns_) = 0;
  }
  if (span_.planar) {
    dot_in_plane(carried_, t_, along_);
    add_angles_squared(result);
  } else {
    carried_ = -carried_;
    Eigen::Index row = first_director_row();
    for (const DirectorRow& held : director_rows_) {
      const double mu = multipliers[row++];
      const DirectionResidual held_residual = residual_of(held);
      couples_[static_cast<std::size_t>(held.piece)] -= mu * held_residual.couple;
      curvatures_[static_cast<std::size_t>(held.piece)] -= mu * held_residual.curvature;
    }
    frames_.add_hessian({&carried_, couples_}, curvatures_, state_, result);
    for (const DirectorRow& held : director_rows_) {
      couples_[static_cast<std::size_t>(held.piece)].setZero();
      curvatures_[static_cast<std::size_t>(held.piece)].setZero();
    }
    if (has_psi()) add_twist_hessian(-multipliers[constraints_ - 1], result);
  }
  if (!has_soft_obstacles() && !contacts_.curved()) return;
  const std::array<Eigen::MatrixXd, 3> tangents = tangent_jacobian();
  auto by_strains = result.topLeftCorner(strains(), strains());
  soft_contact_.add_hessian(tangents, by_strains);
  contacts_.subtract_hessian(multipliers.segment(first_contact_row(), contacts_.count()), tangents,
                             by_strains);
}

/// Second derivatives with the twist psi of what the end's d1 misses, times a factor: psi turns it
/// about the tangent t, after which the strains turn it, which is the sum of both turns and half
/// their cross product. frames_.add_hessian() has left the turns of the end.
void SpanEnergy::add_twist_hessian(double factor, Eigen::MatrixXd& result) {
  const Eigen::Vector3d t = state_.end_frame().col(2);
  const DirectionResidual held_residual = residual_of(director_rows_.back());
  const Eigen::Vector3d turned = held_residual.curvature * t;
  const Eigen::Vector3d mixed = factor / twist_root_ * (turned + t.cross(held_residual.couple) / 2);
  pulled_.head(strains()).noalias() = state_.ends.transpose() * mixed;
  result.col(strains()).head(strains()) += pulled_.head(strains());
  result.row(strains()).head(strains()) += pulled_.head(strains()).transpose();
  result(strains(), strains()) += factor * t.dot(turned) / (twist_root_ * twist_root_);
}

std::array<Eigen::MatrixXd, 3> SpanEnergy::tangent_jacobian() {
  if (!span_.planar) return frames_.tangent_jacobian(state_);
  return {t_theta_.col(0).asDiagonal() * angle_, t_theta_.col(1).asDiagonal() * angle_,
          Eigen::MatrixXd::Zero(angle_.rows(), angle_.cols())};
}

/// Into along_: weight of the node times n.t - kappa^2, which is what the square of an elevation
/// costs there.
void SpanEnergy::carry_sideways(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  carry(multipliers);
  dot_in_plane(carried_, t_, along_);
  const Eigen::Index Q = table_->nodes.size();
  for (Eigen::Index e = 0; e < pieces(); ++e) {
    const double scale = pieces_[static_cast<std::size_t>(e)].strain(0);
    auto kappa = kappa_.segment(e * Q, Q);
    multiply(table_->values.leftCols(terms_), x_.segment(free_start_ + e * terms_, terms_), kappa);
    kappa *= scale;
    const double stiffness = pieces_[static_cast<std::size_t>(e)].stiffness[0];
    along_.segment(e * Q, Q).array() -=
        stiffness * weights_.segment(e * Q, Q).array() * kappa.array().square();
  }
}

bool SpanEnergy::resists_out_of_plane() {
  carry_sideways(Eigen::VectorXd());
  // int beta'^2 >= (pi / 2L)^2 int beta^2 for what a clamp holds at one end.
  const double bending = pi * pi / (4 * span_.length * span_.length);
  if (((along_.array() + bending * weights_.array()) > 0).all()) return true;
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(columns_, columns_);
  add_angles_squared(hessian);
  return is_minimum(hessian);
}

void SpanEnergy::out_of_plane(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                              Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) {
  if (span_.has_material_directors()) return sideways_with_twist(hessian, jacobian);
  carry_sideways(multipliers);
  hessian.setIdentity(columns_, columns_);
  if (free_start_ == 1) hessian(0, 0) = 0;
  add_angles_squared(hessian);
  if (contacts_.curved()) {
    contacts_.subtract_sideways(multipliers.segment(first_contact_row(), contacts_.count()), angle_,
                                hessian);
  }
  if (has_soft_obstacles()) soft_contact_.add_sideways(angle_, hessian);
  jacobian.resize(reach_.cols() + held_angle_.rows(), columns_);
  jacobian.topRows(reach_.cols()).noalias() = reach_.transpose() * angle_;
  jacobian.bottomRows(held_angle_.rows()) = held_angle_;
}

void SpanEnergy::linearise_at(const SpanEnergy& other, const Eigen::VectorXd& x,
                              Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) {
  Eigen::VectorXd gradient(size());
  (void)value(prolong(other, x), gradient);
  Eigen::VectorXd residual(constraints());
  jacobian.resize(constraints(), size());
  constraint(residual, jacobian);
  // The forces are the other one's, seen in these constraints.
  const Eigen::VectorXd multipliers =
      constraints() == 0
          ? Eigen::VectorXd()
          : Eigen::VectorXd(jacobian.transpose().completeOrthogonalDecomposition().solve(gradient));
  this->hessian(multipliers, hessian);
}

/// A rod that is curved, or of another stiffness out of its plane, twists as it leaves it: what the
/// same span in space says.
void SpanEnergy::sideways_with_twist(Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) {
  Span space = span_;
  space.planar = false;
  SpanEnergy twin(space, terms_);
  Eigen::MatrixXd curvature;
  Eigen::MatrixXd all;
  twin.linearise_at(*this, x_, curvature, all);
  const Eigen::Index out = twin.size() - size();
  hessian = curvature.bottomRightCorner(out, out);
  // Of a position its z, of a direction what is across it along z.
  std::vector<Eigen::Index> rows;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) rows.push_back(3 * j + 2);
  for (Eigen::Index row = twin.first_director_row(); row < twin.constraints(); row += 2) {
    rows.push_back(row);
  }
  jacobian.resize(static_cast<Eigen::Index>(rows.size()), out);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    jacobian.row(static_cast<Eigen::Index>(i)) = all.row(rows[i]).tail(out);
  }
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
  result.energy = result.bending - force_.transpose().cwiseProduct(tangents).sum();
  double squared = 0;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const Span::Hold& hold = span_.holds[static_cast<std::size_t>(j)];
    squared += (tangents * reach_.col(j) - hold.offset).squaredNorm();
  }
  result.gap = std::sqrt(squared);
  return result;
}

std::vector<Eigen::Index> SpanEnergy::places_of(const SpanEnergy& other) const {
  std::vector<Eigen::Index> places;
  places.reserve(static_cast<std::size_t>(other.size()));
  for (Eigen::Index field = 0; field < fields(); ++field) {
    const Eigen::Index first = field * columns_;
    if (free_start_ == 1) places.push_back(first);
    for (Eigen::Index e = 0; e < pieces(); ++e) {
      for (Eigen::Index k = 0; k < other.terms_; ++k) {
        places.push_back(first + free_start_ + e * terms_ + k);
      }
    }
  }
  if (has_psi()) places.push_back(strains());
  return places;
}

Eigen::VectorXd SpanEnergy::fit(const StartShape& shape, int most_steps) {
  const Eigen::Matrix3Xd& tangents = shape.tangents;
  if (!span_.planar) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size());
    evaluated_ = false;
    x.head(strains()) = frames_.fit(tangents, most_steps, state_);
    if (fields() == 3 && shape.roll.size() > 0) x = frames_.rolled(x, shape.roll);
    return has_psi() ? with_twist(std::move(x), shape.twist) : x;
  }
  const Eigen::Index nodes = s_.size();
  Eigen::VectorXd angles(nodes);
  double previous = free_start_ == 1 ? angle_of(tangents.col(0)) : start_theta_;
  for (Eigen::Index q = 0; q < nodes; ++q) {
    angles[q] = previous = nearest_turn(angle_of(tangents.col(q)), previous);
  }
  if (natural_angle_.size() > 0) angles -= natural_angle_;
  for (DirectorRow& row : director_rows_) {
    const Eigen::Index last = (row.piece + 1) * table_->nodes.size() - 1;
    row.angle = nearest_turn(row.angle, angles[last]);
  }
  std::vector<double> turns;
  for (const Piece& piece : pieces_) turns.push_back(piece.angle(0));
  std::optional<double> start;
  if (free_start_ == 0) start = start_theta_;
  const FittedAngle fitted = fit_angle(*table_, turns, angles, start);
  Eigen::VectorXd x(columns_);
  if (free_start_ == 1) x[0] = fitted.start;
  x.tail(columns_ - free_start_) = fitted.coefficients;
  return x;
}

void SpanEnergy::unwrap(const Eigen::Ref<const Eigen::VectorXd>& x) {
  if (!span_.planar) return;
  for (std::size_t i = 0; i < director_rows_.size(); ++i) {
    const double angle = start_theta_ + held_angle_.row(static_cast<Eigen::Index>(i)).dot(x);
    director_rows_[i].angle = nearest_turn(director_rows_[i].angle, angle);
  }
}

Eigen::VectorXd SpanEnergy::prolong(const SpanEnergy& other, const Eigen::VectorXd& x) {
  for (std::size_t i = 0; i < director_rows_.size() && other.span_.planar && span_.planar; ++i) {
    director_rows_[i].angle = other.director_rows_[i].angle;
  }
  const Eigen::Index shared = std::min(terms_, other.terms_);
  Eigen::VectorXd prolonged = Eigen::VectorXd::Zero(size());
  // A planar shape's curvature is u1.
  const Eigen::Index known = std::min(fields(), other.fields());
  for (Eigen::Index field = 0; field < known; ++field) {
    const Eigen::Index to = field * columns_;
    const Eigen::Index from = field * other.columns_;
    if (free_start_ == 1) prolonged[to] = x[from];
    if (free_start_ == 1 && other.span_.planar && !span_.planar) {
      prolonged[to] = nearest_turn(x[from] - angle_of(start_frame_.col(2)), 0);
    }
    for (Eigen::Index e = 0; e < pieces(); ++e) {
      prolonged.segment(to + free_start_ + e * terms_, shared) =
          x.segment(from + free_start_ + e * other.terms_, shared);
    }
  }
  if (has_psi() && other.has_psi()) prolonged[strains()] = x[other.strains()];
  return prolonged;
}

Eigen::VectorXd SpanEnergy::prolong_multipliers(const SpanEnergy& other,
                                                const Eigen::VectorXd& multipliers) const {
  if (contacts_.count() == other.contacts_.count()) return multipliers;
  Eigen::VectorXd prolonged(constraints_);
  prolonged.head(first_contact_row()) = multipliers.head(first_contact_row());
  prolonged.segment(first_contact_row(), contacts_.count()) = contacts_.prolong(
      other.contacts_, multipliers.segment(first_contact_row(), other.contacts_.count()));
  const Eigen::Index rest = constraints_ - first_director_row();
  prolonged.tail(rest) = multipliers.tail(rest);
  return prolonged;
}

double SpanEnergy::longest_piece() const {
  double longest = 0;
  for (const Piece& piece : pieces_) longest = std::max(longest, piece.length);
  return longest;
}

double SpanEnergy::tail(const Eigen::VectorXd& x, int terms) const {
  const Eigen::Index last = std::min(terms, 2);
  double tail = 0;
  for (Eigen::Index field = 0; field < fields(); ++field) {
    for (std::size_t e = 0; e < pieces_.size(); ++e) {
      const Eigen::Index end =
          field * columns_ + free_start_ + static_cast<Eigen::Index>(e) * terms_ + terms;
      const double turn = pieces_[e].angle(field);
      tail = std::max(tail, turn * x.segment(end - last, last).cwiseAbs().maxCoeff());
    }
  }
  return tail;
}

SpanShape SpanEnergy::shape(const Eigen::VectorXd& x) const {
  SpanShape shape;
  shape.terms = terms_;
  shape.planar = span_.planar;
  shape.anchor = span_.anchor;
  shape.pieces = pieces_;
  if (span_.planar) {
    shape.start_theta = start_theta_ + (free_start_ == 1 ? x[0] : 0);
    shape.theta = x.tail(columns_ - free_start_);
  } else {
    shape.start_frame = start_frame_;
    shape.free_start = free_start_ == 1;
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
  for (Eigen::Index f = 0; f < fields() && free_start_ == 1; ++f) stored[f * columns_] = 0;
  const Eigen::Index bends = std::min<Eigen::Index>(fields(), 2) * columns_;
  energies.bending = stored.head(bends).squaredNorm() / 2;
  energies.twisting = stored.tail(stored.size() - bends).squaredNorm() / 2;
  if (!span_.loads.empty()) {
    const PositionOperator reach(span_, pieces_, *table_);
    for (const Span::Load& load : span_.loads) {
      const Eigen::VectorXd at = reach.begin(pieces_before(pieces_, load.at));
      energies.load -= load.force.dot(t_.transpose() * at);
    }
  }
  energies.gravity = -force_.cwiseProduct(t_).sum() - energies.load;
  if (couples_work_.size() > 0) energies.load -= couples_work_.dot(x);
  for (const Span::Load& load : span_.loads) {
    if (natural_angle_.size() > 0)
      energies.load -= load.couple * span_.natural.integral(load.at).x();
  }
  energies.contact = soft_contact_.energy();
  return energies;
}

}  // namespace dlo::energy_model
