#include "span_energy.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "free_directions.hpp"
#include "legendre.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Up to these sizes dot products, and products with vectors, are faster than one of matrices,
/// which packs its operands first.
constexpr Eigen::Index most_for_dots = 12;
constexpr Eigen::Index most_for_vectors = 20;

double angle_of(const Eigen::Vector3d& direction) {
  return std::atan2(direction.y(), direction.x());
}

double elevation_of(const Eigen::Vector3d& direction) {
  return std::asin(std::clamp(direction.z() / direction.norm(), -1.0, 1.0));
}

/// The angle that differs from `angle` by whole turns and is nearest to `target`.
double nearest_turn(double angle, double target) {
  return angle + 2 * pi * std::round((target - angle) / (2 * pi));
}

/// Adds basis^T diag(by_node) basis to a symmetric matrix.
void add_weighted_gram(const Eigen::VectorXd& by_node, const Eigen::MatrixXd& basis,
                       Eigen::MatrixXd& scaled, Eigen::Ref<Eigen::MatrixXd> result) {
  scaled.noalias() = by_node.asDiagonal() * basis;
  const Eigen::Index columns = basis.cols();
  if (columns > most_for_vectors) {
    result.noalias() += basis.transpose() * scaled;
    return;
  }
  for (Eigen::Index j = 0; j < columns; ++j) {
    const Eigen::Index rows = columns - j;
    if (columns > most_for_dots) {
      result.col(j).tail(rows).noalias() += basis.rightCols(rows).transpose() * scaled.col(j);
    } else {
      for (Eigen::Index i = j; i < columns; ++i) result(i, j) += basis.col(i).dot(scaled.col(j));
    }
    result.row(j).tail(rows - 1) = result.col(j).tail(rows - 1).transpose();
  }
}

}  // namespace

void SpanEnergy::tabulate_angles() {
  const LegendreTable& table = legendre_table(terms_);
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index K = terms_;
  const auto count = static_cast<Eigen::Index>(pieces_.size());
  const Eigen::Index nodes = count * Q;
  columns_ = free_start_ + count * K;
  s_.resize(nodes);
  weights_.resize(nodes);
  angle_.setZero(nodes, columns_);
  if (fields_ == 2) slope_.setZero(nodes, columns_);
  end_angle_.setZero(columns_);
  if (free_start_ == 1) {
    angle_.col(0).setOnes();
    end_angle_[0] = 1;
  }
  for (Eigen::Index e = 0; e < count; ++e) {
    const Piece& piece = pieces_[static_cast<std::size_t>(e)];
    const double root = std::sqrt(piece.length);
    const Eigen::Index column = free_start_ + e * K;
    s_.segment(e * Q, Q) = piece.begin + piece.length * table.nodes.array();
    weights_.segment(e * Q, Q) = piece.length * table.weights;
    angle_.block(e * Q, column, Q, K) = root * table.integrals.leftCols(K);
    // Only p_0 turns the tangent over a whole piece.
    angle_.col(column).tail((count - e - 1) * Q).setConstant(root);
    end_angle_[column] = root;
    if (fields_ == 2) slope_.block(e * Q, column, Q, K) = table.values.leftCols(K) / root;
  }
}

void SpanEnergy::tabulate_forces() {
  const Eigen::Index nodes = s_.size();
  force_.resize(nodes, 3);
  for (Eigen::Index q = 0; q < nodes; ++q) {
    // What hangs beyond a node, seen from the anchor.
    const bool after = s_[q] > span_.anchor;
    Eigen::Vector3d n = (after ? span_.length - s_[q] : -s_[q]) * span_.weight;
    for (const Span::Load& load : span_.loads) {
      if (after && load.at > s_[q]) n += load.force;
      if (!after && load.at < s_[q]) n -= load.force;
    }
    force_.row(q) = weights_[q] * n.transpose();
  }
  reach_.setZero(nodes, static_cast<Eigen::Index>(span_.holds.size()));
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const double at = span_.holds[static_cast<std::size_t>(j)].at;
    for (Eigen::Index q = 0; q < nodes; ++q) {
      if (s_[q] > span_.anchor && s_[q] < at) reach_(q, j) = weights_[q];
      if (s_[q] < span_.anchor && s_[q] > at) reach_(q, j) = -weights_[q];
    }
  }
}

void SpanEnergy::reset(const Span& span, int terms) {
  span_ = span;
  terms_ = terms;
  fields_ = span.planar ? 1 : 2;
  axes_ = span.planar ? 2 : 3;
  free_start_ = span.start_direction ? 0 : 1;
  pieces_ = pieces_of(span);
  tabulate_angles();
  tabulate_forces();
  constraints_ = axes_ * reach_.cols() + (span.end_direction ? fields_ : 0);
  start_theta_ = span.start_direction ? angle_of(*span.start_direction) : 0;
  start_beta_ = span.start_direction ? elevation_of(*span.start_direction) : 0;
  if (span.end_direction) {
    end_theta_ = nearest_turn(angle_of(*span.end_direction), start_theta_);
    end_beta_ = elevation_of(*span.end_direction);
  }
  const Eigen::Index nodes = s_.size();
  for (Eigen::VectorXd* v : {&theta_, &beta_, &kappa_, &along_, &turning_}) v->setZero(nodes);
  for (Eigen::MatrixX3d* m : {&t_, &t_theta_, &t_beta_, &total_, &carried_}) m->setZero(nodes, 3);
  scaled_.resize(nodes, columns_);
  x_.setZero(size());
  gradient_.setZero(size());
  evaluated_ = false;
  walls_.reset(span_, pieces_, terms_, s_, weights_);
}

double SpanEnergy::value(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> gradient) {
  if (evaluated_ && !has_walls() && x == x_) {
    gradient = gradient_;
    return energy_;
  }
  x_ = x;
  theta_.noalias() = angle_ * x.head(columns_);
  theta_.array() += start_theta_;
  gradient = x;
  if (free_start_ == 1) {
    gradient[0] = 0;
    if (fields_ == 2) gradient[columns_] = 0;
  }
  double energy = gradient.dot(x) / 2;
  const Eigen::Index nodes = theta_.size();
  if (fields_ == 1) {
    for (Eigen::Index q = 0; q < nodes; ++q) {
      const double c = std::cos(theta_[q]);
      const double s = std::sin(theta_[q]);
      t_(q, 0) = c;
      t_(q, 1) = s;
      t_theta_(q, 0) = -s;
      t_theta_(q, 1) = c;
    }
  } else {
    beta_.noalias() = angle_ * x.tail(columns_);
    beta_.array() += start_beta_;
    kappa_.noalias() = slope_ * x.head(columns_);
    for (Eigen::Index q = 0; q < nodes; ++q) {
      const double c = std::cos(theta_[q]);
      const double s = std::sin(theta_[q]);
      const double cb = std::cos(beta_[q]);
      const double sb = std::sin(beta_[q]);
      t_.row(q) << cb * c, cb * s, sb;
      t_theta_.row(q) << -cb * s, cb * c, 0;
      t_beta_.row(q) << -sb * c, -sb * s, cb;
      energy -= weights_[q] * sb * sb * kappa_[q] * kappa_[q] / 2;
    }
  }
  energy -= force_.cwiseProduct(t_).sum();
  total_ = force_;
  if (has_walls()) energy += walls_.add(t_, total_);

  turning_ = total_.cwiseProduct(t_theta_).rowwise().sum();
  gradient.head(columns_).noalias() -= angle_.transpose() * turning_;
  if (fields_ == 2) {
    turning_ = weights_.array() * t_.col(2).array().square() * kappa_.array();
    gradient.head(columns_).noalias() -= slope_.transpose() * turning_;
    turning_ = total_.cwiseProduct(t_beta_).rowwise().sum();
    turning_.array() +=
        weights_.array() * t_.col(2).array() * t_beta_.col(2).array() * kappa_.array().square();
    gradient.tail(columns_).noalias() -= angle_.transpose() * turning_;
  }
  gradient_ = gradient;
  energy_ = energy;
  evaluated_ = true;
  return energy;
}

void SpanEnergy::constraint(Eigen::Ref<Eigen::VectorXd> residual,
                            Eigen::Ref<Eigen::MatrixXd> jacobian) {
  Eigen::Index row = 0;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis, ++row) {
      residual[row] =
          t_.col(axis).dot(reach_.col(j)) - span_.holds[static_cast<std::size_t>(j)].offset[axis];
      turning_ = t_theta_.col(axis).cwiseProduct(reach_.col(j));
      jacobian.row(row).head(columns_).noalias() = turning_.transpose() * angle_;
      if (fields_ == 2) {
        turning_ = t_beta_.col(axis).cwiseProduct(reach_.col(j));
        jacobian.row(row).tail(columns_).noalias() = turning_.transpose() * angle_;
      }
    }
  }
  if (!span_.end_direction) return;
  jacobian.bottomRows(fields_).setZero();
  residual[row] = start_theta_ + end_angle_.dot(x_.head(columns_)) - end_theta_;
  jacobian.row(row).head(columns_) = end_angle_.transpose();
  if (fields_ == 2) {
    ++row;
    residual[row] = start_beta_ + end_angle_.dot(x_.tail(columns_)) - end_beta_;
    jacobian.row(row).tail(columns_) = end_angle_.transpose();
  }
}

void SpanEnergy::carry(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  carried_ = total_;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis) {
      carried_.col(axis) += multipliers[j * axes_ + axis] * reach_.col(j);
    }
  }
  along_ = carried_.cwiseProduct(t_).rowwise().sum();
}

void SpanEnergy::hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                         Eigen::MatrixXd& result) {
  carry(multipliers);
  result.setIdentity(size(), size());
  if (free_start_ == 1) {
    result(0, 0) = 0;
    if (fields_ == 2) result(columns_, columns_) = 0;
  }
  // Adds basis^T diag(by_node) basis to a block on the diagonal.
  const auto add = [&](const Eigen::VectorXd& by_node, const Eigen::MatrixXd& basis,
                       Eigen::Index begin) {
    add_weighted_gram(by_node, basis, scaled_, result.block(begin, begin, columns_, columns_));
  };
  // Adds left^T diag(by_node) angle to the block of azimuths by elevations.
  const auto add_beside = [&](const Eigen::VectorXd& by_node, const Eigen::MatrixXd& left) {
    scaled_.noalias() = by_node.asDiagonal() * angle_;
    result.topRightCorner(columns_, columns_).noalias() += left.transpose() * scaled_;
  };
  if (fields_ == 1) {
    add(along_, angle_, 0);
  } else {
    const auto w = weights_.array();
    const auto k = kappa_.array();
    const auto sb = t_.col(2).array();
    const auto cb = t_beta_.col(2).array();
    // n . (cos theta, sin theta, 0) is what theta's second derivative leaves of n . t.
    turning_ = carried_.leftCols(2).cwiseProduct(t_.leftCols(2)).rowwise().sum();
    add(turning_, angle_, 0);
    turning_ = -w * sb.square();
    add(turning_, slope_, 0);
    // d2 t / d theta d beta = -tan(beta) dt / d theta, written without the division.
    for (Eigen::Index q = 0; q < turning_.size(); ++q) {
      turning_[q] =
          sb[q] * (carried_(q, 1) * std::cos(theta_[q]) - carried_(q, 0) * std::sin(theta_[q]));
    }
    add_beside(turning_, angle_);
    turning_ = -2 * w * sb * cb * k;
    add_beside(turning_, slope_);
    result.bottomLeftCorner(columns_, columns_) =
        result.topRightCorner(columns_, columns_).transpose();
    turning_ = along_.array() - w * (cb.square() - sb.square()) * k.square();
    add(turning_, angle_, columns_);
  }
  if (has_walls()) {
    walls_.add_hessian(t_theta_, fields_ == 2 ? &t_beta_ : nullptr, angle_, result);
  }
}

/// Into along_: weight of the node times n.t - kappa^2, which is what the square of an elevation
/// costs there.
void SpanEnergy::carry_sideways(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  carry(multipliers);
  const LegendreTable& table = legendre_table(terms_);
  const Eigen::Index Q = table.nodes.size();
  for (Eigen::Index e = 0; e < pieces(); ++e) {
    const double root = std::sqrt(pieces_[static_cast<std::size_t>(e)].length);
    kappa_.segment(e * Q, Q).noalias() =
        table.values.leftCols(terms_) * x_.segment(free_start_ + e * terms_, terms_) / root;
  }
  along_.array() -= weights_.array() * kappa_.array().square();
}

bool SpanEnergy::resists_sideways() {
  carry_sideways(Eigen::VectorXd());
  // int beta'^2 >= (pi / 2L)^2 int beta^2 for what a clamp holds at one end.
  const double bending = pi * pi / (4 * span_.length * span_.length);
  if (((along_.array() + bending * weights_.array()) > 0).all()) return true;
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(columns_, columns_);
  add_weighted_gram(along_, angle_, scaled_, hessian);
  return is_minimum(hessian);
}

void SpanEnergy::sideways(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                          Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) {
  carry_sideways(multipliers);
  hessian.setIdentity(columns_, columns_);
  if (free_start_ == 1) hessian(0, 0) = 0;
  add_weighted_gram(along_, angle_, scaled_, hessian);
  jacobian.resize(reach_.cols() + (span_.end_direction ? 1 : 0), columns_);
  jacobian.topRows(reach_.cols()).noalias() = reach_.transpose() * angle_;
  if (span_.end_direction) jacobian.bottomRows(1) = end_angle_.transpose();
}

Eigen::VectorXd SpanEnergy::fit_field(const Eigen::VectorXd& angles, double start) const {
  const LegendreTable& table = legendre_table(terms_);
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index K = terms_;
  const auto count = static_cast<Eigen::Index>(pieces_.size());
  // Every piece on its own, with the angle where it begins; then p_0 makes them meet.
  Eigen::MatrixXd own(K + 1, count);
  for (Eigen::Index e = 0; e < count; ++e) {
    own.col(e).noalias() = table.fit * angles.segment(e * Q, Q);
  }
  const double end = own(0, count - 1) + own(1, count - 1);
  Eigen::VectorXd x(columns_);
  if (free_start_ == 1) x[0] = own(0, 0);
  if (free_start_ == 0) own(0, 0) = start;
  for (Eigen::Index e = 0; e < count; ++e) {
    own(1, e) = (e + 1 < count ? own(0, e + 1) : end) - own(0, e);
    const double root = std::sqrt(pieces_[static_cast<std::size_t>(e)].length);
    x.segment(free_start_ + e * K, K) = own.col(e).tail(K) / root;
  }
  return x;
}

Eigen::VectorXd SpanEnergy::fit(const Eigen::Matrix3Xd& tangents) {
  const Eigen::Index nodes = s_.size();
  Eigen::VectorXd angles(nodes);
  double previous = free_start_ == 1 ? angle_of(tangents.col(0)) : start_theta_;
  for (Eigen::Index q = 0; q < nodes; ++q) {
    angles[q] = previous = nearest_turn(angle_of(tangents.col(q)), previous);
  }
  if (span_.end_direction) end_theta_ = nearest_turn(end_theta_, previous);
  Eigen::VectorXd x(size());
  x.head(columns_) = fit_field(angles, start_theta_);
  if (fields_ == 2) {
    for (Eigen::Index q = 0; q < nodes; ++q) angles[q] = elevation_of(tangents.col(q));
    x.tail(columns_) = fit_field(angles, start_beta_);
  }
  return x;
}

Eigen::VectorXd SpanEnergy::adopt(const SpanEnergy& other, const Eigen::VectorXd& x) {
  end_theta_ = other.end_theta_;
  const Eigen::Index shared = std::min(terms_, other.terms_);
  Eigen::VectorXd adopted = Eigen::VectorXd::Zero(size());
  for (Eigen::Index field = 0; field < other.fields_; ++field) {
    const Eigen::Index to = field * columns_;
    const Eigen::Index from = field * other.columns_;
    if (free_start_ == 1) adopted[to] = x[from];
    for (Eigen::Index e = 0; e < pieces(); ++e) {
      adopted.segment(to + free_start_ + e * terms_, shared) =
          x.segment(from + free_start_ + e * other.terms_, shared);
    }
  }
  return adopted;
}

double SpanEnergy::tail(const Eigen::VectorXd& x) const {
  const Eigen::Index last = std::min(terms_, 2);
  double tail = 0;
  for (Eigen::Index field = 0; field < fields_; ++field) {
    for (std::size_t e = 0; e < pieces_.size(); ++e) {
      const Eigen::Index end =
          field * columns_ + free_start_ + (static_cast<Eigen::Index>(e) + 1) * terms_;
      // A coefficient bends its piece by sqrt(length) of itself.
      tail = std::max(
          tail, x.segment(end - last, last).cwiseAbs().maxCoeff() * std::sqrt(pieces_[e].length));
    }
  }
  return tail;
}

SpanShape SpanEnergy::shape(const Eigen::VectorXd& x) const {
  SpanShape shape;
  shape.terms = terms_;
  shape.planar = fields_ == 1;
  shape.anchor = span_.anchor;
  shape.pieces = pieces_;
  shape.start_theta = start_theta_ + (free_start_ == 1 ? x[0] : 0);
  shape.theta = x.segment(free_start_, columns_ - free_start_);
  if (fields_ == 2) {
    shape.start_beta = start_beta_ + (free_start_ == 1 ? x[columns_] : 0);
    shape.beta = x.tail(columns_ - free_start_);
  }
  return shape;
}

Energies SpanEnergy::energies(const Eigen::VectorXd& x) {
  Eigen::VectorXd gradient(x.size());
  (void)value(x, gradient);
  Energies energies;
  energies.bending = x.squaredNorm() / 2;
  if (free_start_ == 1) energies.bending -= x[0] * x[0] / 2;
  if (fields_ == 2) {
    if (free_start_ == 1) energies.bending -= x[columns_] * x[columns_] / 2;
    turning_ = weights_.array() * t_.col(2).array().square() * kappa_.array().square();
    energies.bending -= turning_.sum() / 2;
  }
  // A load's point is the sum of the tangents between it and the anchor.
  for (const Span::Load& load : span_.loads) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (Eigen::Index q = 0; q < s_.size(); ++q) {
      if (s_[q] > span_.anchor && s_[q] < load.at) point += weights_[q] * t_.row(q).transpose();
      if (s_[q] < span_.anchor && s_[q] > load.at) point -= weights_[q] * t_.row(q).transpose();
    }
    energies.load -= load.force.dot(point);
  }
  energies.gravity = -force_.cwiseProduct(t_).sum() - energies.load;
  return energies;
}

}  // namespace dlo::energy_model
