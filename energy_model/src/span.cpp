#include "span.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "legendre.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Cuts closer than this would make pieces too short for a curvature of their own.
constexpr double closest_cuts = 1e-9;

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

/// int_0^{x_i} of the polynomial through the values at the nodes of a rule: Q x Q.
Eigen::MatrixXd integration_matrix(const LegendreTable& rule) {
  const Eigen::Index Q = rule.nodes.size();
  Eigen::MatrixXd values(Q, Q);
  Eigen::MatrixXd integrals(Q, Q);
  Eigen::VectorXd p(Q);
  Eigen::VectorXd integral(Q);
  for (Eigen::Index q = 0; q < Q; ++q) {
    legendre(rule.nodes[q], p, integral);
    values.row(q) = p;
    integrals.row(q) = integral;
  }
  return integrals * values.transpose() * rule.weights.asDiagonal();
}

}  // namespace

double Span::total_load() const {
  double total = weight.norm() * length;
  for (const Load& load : loads) total += load.force.norm();
  return total;
}

void SpanEnergy::cut(const std::vector<double>& more_cuts) {
  std::vector<double> cuts = {0, span_.length, span_.anchor};
  for (const Span::Hold& hold : span_.holds) cuts.push_back(hold.at);
  for (const Span::Load& load : span_.loads) cuts.push_back(load.at);
  cuts.insert(cuts.end(), more_cuts.begin(), more_cuts.end());
  std::sort(cuts.begin(), cuts.end());
  pieces_.clear();
  double begin = 0;
  for (const double c : cuts) {
    if (c - begin < closest_cuts) continue;
    const double end = span_.length - c < closest_cuts ? span_.length : c;
    pieces_.push_back({begin, end - begin});
    begin = end;
  }
}

SpanEnergy::SpanEnergy(const Span& span, int terms)
    : span_(span), terms_(terms), fields_(span.planar ? 1 : 2), axes_(span.planar ? 2 : 3) {
  // A soft rod bends in layers at its clamps; the cuts are where they have decayed by exp(-6) and
  // exp(-24), so that no piece has to resolve all of a layer.
  std::vector<double> layer_cuts;
  const double layer = 1 / std::sqrt(std::max(1.0, span.total_load()));
  constexpr double depths[] = {6, 24};
  constexpr double furthest = 0.7;
  const double room = span.end_direction ? 0.4 : furthest;
  if (depths[1] * layer < room * span.length) {
    for (const double depth : depths) {
      layer_cuts.push_back(depth * layer);
      if (span.end_direction) layer_cuts.push_back(span.length - depth * layer);
    }
  }
  cut(layer_cuts);

  const LegendreTable& table = legendre_table(terms);
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index K = terms;
  const auto count = static_cast<Eigen::Index>(pieces_.size());
  const Eigen::Index free_start = span.start_direction ? 0 : 1;
  columns_ = free_start + count * K;
  const Eigen::Index nodes = count * Q;
  s_.resize(nodes);
  weights_.resize(nodes);
  angle_.setZero(nodes, columns_);
  slope_.setZero(nodes, columns_);
  end_angle_.setZero(columns_);
  if (free_start == 1) {
    angle_.col(0).setOnes();
    end_angle_[0] = 1;
  }
  for (Eigen::Index e = 0; e < count; ++e) {
    const Piece& piece = pieces_[static_cast<std::size_t>(e)];
    const double root = std::sqrt(piece.length);
    const Eigen::Index column = free_start + e * K;
    s_.segment(e * Q, Q) = piece.begin + piece.length * table.nodes.array();
    weights_.segment(e * Q, Q) = piece.length * table.weights;
    angle_.block(e * Q, column, Q, K) = root * table.integrals;
    // Only p_0 turns the tangent over a whole piece.
    angle_.col(column).tail((count - e - 1) * Q).setConstant(root);
    end_angle_[column] = root;
    slope_.block(e * Q, column, Q, K) = table.values / root;
  }

  force_.resize(3, nodes);
  for (Eigen::Index q = 0; q < nodes; ++q) {
    // What hangs beyond a node, seen from the anchor.
    const bool after = s_[q] > span.anchor;
    Eigen::Vector3d n = (after ? span.length - s_[q] : -s_[q]) * span.weight;
    for (const Span::Load& load : span.loads) {
      if (after && load.at > s_[q]) n += load.force;
      if (!after && load.at < s_[q]) n -= load.force;
    }
    force_.col(q) = weights_[q] * n;
  }
  reach_.setZero(nodes, static_cast<Eigen::Index>(span.holds.size()));
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    const double at = span.holds[static_cast<std::size_t>(j)].at;
    for (Eigen::Index q = 0; q < nodes; ++q) {
      if (s_[q] > span.anchor && s_[q] < at) reach_(q, j) = weights_[q];
      if (s_[q] < span.anchor && s_[q] > at) reach_(q, j) = -weights_[q];
    }
  }
  constraints_ = axes_ * reach_.cols() + (span.end_direction ? fields_ : 0);

  if (span.start_direction) {
    start_theta_ = angle_of(*span.start_direction);
    start_beta_ = elevation_of(*span.start_direction);
  }
  if (span.end_direction) {
    end_theta_ = nearest_turn(angle_of(*span.end_direction), start_theta_);
    end_beta_ = elevation_of(*span.end_direction);
  }
  theta_.setZero(nodes);
  beta_.setZero(nodes);
  kappa_.setZero(nodes);
  t_.setZero(3, nodes);
  t_theta_.setZero(3, nodes);
  t_beta_.setZero(3, nodes);
  total_.setZero(3, nodes);
  x_.setZero(size());

  if (has_walls()) {
    const Eigen::MatrixXd integration = integration_matrix(table);
    position_.setZero(nodes, nodes);
    for (Eigen::Index e = 0; e < count; ++e) {
      const double length = pieces_[static_cast<std::size_t>(e)].length;
      position_.block(e * Q, e * Q, Q, Q) = length * integration;
      for (Eigen::Index before = 0; before < e; ++before) {
        position_.block(e * Q, before * Q, Q, Q).rowwise() =
            weights_.segment(before * Q, Q).transpose();
      }
    }
    // From the anchor instead of from the start.
    Eigen::RowVectorXd to_anchor = Eigen::RowVectorXd::Zero(nodes);
    for (Eigen::Index q = 0; q < nodes; ++q) {
      if (s_[q] < span.anchor) to_anchor[q] = weights_[q];
    }
    position_.rowwise() -= to_anchor;
    const auto walls = static_cast<Eigen::Index>(span.walls.size());
    clearance_.setZero(nodes, walls);
    contact_.setZero(nodes, walls);
    pressure_.setZero(nodes, walls);
    // Stiff enough that the multipliers settle in a few rounds, soft enough for Newton's method.
    contact_stiffness_ = 1e6 * (1 + span.total_load()) / (span.length * span.length);
  }
}

double SpanEnergy::value(const Eigen::Ref<const Eigen::VectorXd>& x,
                         Eigen::Ref<Eigen::VectorXd> gradient) {
  x_ = x;
  theta_.noalias() = angle_ * x.head(columns_);
  theta_.array() += start_theta_;
  gradient = x;
  if (!span_.start_direction) {
    gradient[0] = 0;
    if (fields_ == 2) gradient[columns_] = 0;
  }
  double energy = gradient.dot(x) / 2;
  const Eigen::Index nodes = theta_.size();
  if (fields_ == 1) {
    for (Eigen::Index q = 0; q < nodes; ++q) {
      const double c = std::cos(theta_[q]);
      const double s = std::sin(theta_[q]);
      t_.col(q) << c, s, 0;
      t_theta_.col(q) << -s, c, 0;
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
      t_.col(q) << cb * c, cb * s, sb;
      t_theta_.col(q) << -cb * s, cb * c, 0;
      t_beta_.col(q) << -sb * c, -sb * s, cb;
      energy -= weights_[q] * sb * sb * kappa_[q] * kappa_[q] / 2;
    }
  }
  total_ = force_;
  energy -= force_.cwiseProduct(t_).sum();
  if (has_walls()) add_wall_terms(energy);

  gradient.head(columns_).noalias() -=
      angle_.transpose() * total_.cwiseProduct(t_theta_).colwise().sum().transpose();
  if (fields_ == 2) {
    const Eigen::ArrayXd sb = t_.row(2).transpose().array();
    const Eigen::ArrayXd cb = t_beta_.row(2).transpose().array();
    const Eigen::ArrayXd bent = weights_.array() * sb * kappa_.array();
    gradient.head(columns_).noalias() -= slope_.transpose() * (bent * sb).matrix();
    gradient.tail(columns_).noalias() -=
        angle_.transpose() * ((bent * cb * kappa_.array()).matrix() +
                              total_.cwiseProduct(t_beta_).colwise().sum().transpose());
  }
  return energy;
}

void SpanEnergy::constraint(Eigen::Ref<Eigen::VectorXd> residual,
                            Eigen::Ref<Eigen::MatrixXd> jacobian) const {
  Eigen::Index row = 0;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis, ++row) {
      residual[row] =
          t_.row(axis) * reach_.col(j) - span_.holds[static_cast<std::size_t>(j)].offset[axis];
      jacobian.row(row).head(columns_).noalias() =
          (t_theta_.row(axis).transpose().cwiseProduct(reach_.col(j))).transpose() * angle_;
      if (fields_ == 2) {
        jacobian.row(row).tail(columns_).noalias() =
            (t_beta_.row(axis).transpose().cwiseProduct(reach_.col(j))).transpose() * angle_;
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

void SpanEnergy::hessian(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                         Eigen::MatrixXd& result) {
  Eigen::Matrix3Xd n = total_;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis) {
      n.row(axis) += multipliers[j * axes_ + axis] * reach_.col(j).transpose();
    }
  }
  result.setZero(size(), size());
  const Eigen::Index first = span_.start_direction ? 0 : 1;
  result.diagonal().setOnes();
  if (first == 1) {
    result(0, 0) = 0;
    if (fields_ == 2) result(columns_, columns_) = 0;
  }
  if (fields_ == 1) {
    const Eigen::VectorXd along = n.cwiseProduct(t_).colwise().sum();
    result.noalias() += angle_.transpose() * along.asDiagonal() * angle_;
  } else {
    const Eigen::ArrayXd sb = t_.row(2).transpose().array();
    const Eigen::ArrayXd cb = t_beta_.row(2).transpose().array();
    const Eigen::ArrayXd w = weights_.array();
    const Eigen::ArrayXd k = kappa_.array();
    const Eigen::ArrayXd c = theta_.array().cos();
    const Eigen::ArrayXd s = theta_.array().sin();
    const Eigen::ArrayXd nx = n.row(0).transpose().array();
    const Eigen::ArrayXd ny = n.row(1).transpose().array();
    const Eigen::VectorXd theta_theta = cb * (nx * c + ny * s);
    const Eigen::VectorXd theta_beta = sb * (ny * c - nx * s);
    const Eigen::VectorXd beta_beta =
        n.cwiseProduct(t_).colwise().sum().transpose().array() - w * (cb * cb - sb * sb) * k * k;
    const Eigen::VectorXd slope_slope = w * sb * sb;
    const Eigen::VectorXd slope_beta = 2 * w * sb * cb * k;
    result.topLeftCorner(columns_, columns_).noalias() +=
        angle_.transpose() * theta_theta.asDiagonal() * angle_ -
        slope_.transpose() * slope_slope.asDiagonal() * slope_;
    result.topRightCorner(columns_, columns_).noalias() =
        angle_.transpose() * theta_beta.asDiagonal() * angle_ -
        slope_.transpose() * slope_beta.asDiagonal() * angle_;
    result.bottomLeftCorner(columns_, columns_) =
        result.topRightCorner(columns_, columns_).transpose();
    result.bottomRightCorner(columns_, columns_).noalias() +=
        angle_.transpose() * beta_beta.asDiagonal() * angle_;
  }
  for (std::size_t i = 0; i < span_.walls.size(); ++i) {
    // Springs of the nodes in contact: k w (N . dr)(N . dr)^T
    const Span::Wall& wall = span_.walls[i];
    const auto column = static_cast<Eigen::Index>(i);
    const double stiffness = std::isfinite(wall.stiffness) ? wall.stiffness : contact_stiffness_;
    Eigen::MatrixXd dr(theta_.size(), size());
    const Eigen::VectorXd by_theta = wall.normal.transpose() * t_theta_;
    dr.leftCols(columns_).noalias() = position_ * by_theta.asDiagonal() * angle_;
    if (fields_ == 2) {
      const Eigen::VectorXd by_beta = wall.normal.transpose() * t_beta_;
      dr.rightCols(columns_).noalias() = position_ * by_beta.asDiagonal() * angle_;
    }
    const Eigen::VectorXd springs =
        (pressure_.col(column).array() > 0).select(stiffness * weights_.array(), 0.0);
    result.noalias() += dr.transpose() * springs.asDiagonal() * dr;
  }
}

void SpanEnergy::sideways(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                          Eigen::MatrixXd& hessian, Eigen::MatrixXd& jacobian) const {
  Eigen::Matrix3Xd n = total_;
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    for (Eigen::Index axis = 0; axis < axes_; ++axis) {
      n.row(axis) += multipliers[j * axes_ + axis] * reach_.col(j).transpose();
    }
  }
  const Eigen::VectorXd kappa = slope_ * x_.head(columns_);
  const Eigen::VectorXd curve = n.cwiseProduct(t_).colwise().sum().transpose().array() -
                                weights_.array() * kappa.array() * kappa.array();
  hessian.setZero(columns_, columns_);
  hessian.diagonal().setOnes();
  if (!span_.start_direction) hessian(0, 0) = 0;
  hessian.noalias() += angle_.transpose() * curve.asDiagonal() * angle_;
  jacobian.resize(reach_.cols() + (span_.end_direction ? 1 : 0), columns_);
  jacobian.topRows(reach_.cols()).noalias() = reach_.transpose() * angle_;
  if (span_.end_direction) jacobian.bottomRows(1) = end_angle_.transpose();
}

Eigen::VectorXd SpanEnergy::fit(const Eigen::Matrix3Xd& tangents) {
  const Eigen::Index nodes = s_.size();
  Eigen::VectorXd theta(nodes);
  Eigen::VectorXd beta(nodes);
  double previous = start_theta_;
  if (!span_.start_direction) previous = angle_of(tangents.col(0));
  for (Eigen::Index q = 0; q < nodes; ++q) {
    theta[q] = nearest_turn(angle_of(tangents.col(q)), previous);
    beta[q] = elevation_of(tangents.col(q));
    previous = theta[q];
  }
  if (span_.end_direction) end_theta_ = nearest_turn(end_theta_, previous);
  // The slopes' coefficients are weighted lightly, so that nodes and unknowns need not match.
  const Eigen::VectorXd root = weights_.cwiseSqrt();
  Eigen::MatrixXd matrix(nodes + columns_, columns_);
  matrix << root.asDiagonal() * angle_, Eigen::MatrixXd::Identity(columns_, columns_) * 1e-7;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(matrix);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(nodes + columns_);
  Eigen::VectorXd x(size());
  right.head(nodes) = root.cwiseProduct((theta.array() - start_theta_).matrix());
  x.head(columns_) = qr.solve(right);
  if (fields_ == 2) {
    right.head(nodes) = root.cwiseProduct((beta.array() - start_beta_).matrix());
    x.tail(columns_) = qr.solve(right);
  }
  return x;
}

double SpanEnergy::tail(const Eigen::VectorXd& x) const {
  const Eigen::Index first = span_.start_direction ? 0 : 1;
  const Eigen::Index last = std::min(terms_, 2);
  double tail = 0;
  for (Eigen::Index field = 0; field < fields_; ++field) {
    for (std::size_t e = 0; e < pieces_.size(); ++e) {
      const Eigen::Index end =
          field * columns_ + first + (static_cast<Eigen::Index>(e) + 1) * terms_;
      // A coefficient bends its piece by sqrt(length) of itself.
      tail = std::max(
          tail, x.segment(end - last, last).cwiseAbs().maxCoeff() * std::sqrt(pieces_[e].length));
    }
  }
  return tail;
}

double SpanEnergy::elevation() const { return beta_.cwiseAbs().maxCoeff(); }

SpanSamples SpanEnergy::sample(const Eigen::VectorXd& x, const std::vector<double>& s) const {
  const LegendreTable& table = legendre_table(terms_);
  const Eigen::Index K = terms_;
  const Eigen::Index first = span_.start_direction ? 0 : 1;
  Eigen::VectorXd values(K);
  Eigen::VectorXd integrals(K);
  struct State {
    double theta, beta, kappa_theta, kappa_beta;
    Eigen::Vector3d point;

    [[nodiscard]] Eigen::Vector3d tangent() const {
      return {std::cos(beta) * std::cos(theta), std::cos(beta) * std::sin(theta), std::sin(beta)};
    }
  };
  // Angles at a share xi of piece e, which starts in `start`.
  const auto angles = [&](std::size_t e, double xi, const State& start) {
    legendre(xi, values, integrals);
    const double root = std::sqrt(pieces_[e].length);
    const Eigen::Index column = first + static_cast<Eigen::Index>(e) * K;
    State state = start;
    state.theta += root * integrals.dot(x.segment(column, K));
    state.kappa_theta = values.dot(x.segment(column, K)) / root;
    if (fields_ == 2) {
      state.beta += root * integrals.dot(x.segment(columns_ + column, K));
      state.kappa_beta = values.dot(x.segment(columns_ + column, K)) / root;
    }
    return state;
  };
  const auto advance = [&](std::size_t e, double xi, const State& start) {
    Eigen::Vector3d point = start.point;
    for (Eigen::Index q = 0; q < table.nodes.size(); ++q) {
      point += pieces_[e].length * xi * table.weights[q] *
               angles(e, xi * table.nodes[q], start).tangent();
    }
    State end = angles(e, xi, start);
    end.point = point;
    return end;
  };

  State begin{start_theta_, start_beta_, 0, 0, Eigen::Vector3d::Zero()};
  if (first == 1) {
    begin.theta += x[0];
    if (fields_ == 2) begin.beta += x[columns_];
  }
  std::vector<State> starts = {begin};
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    starts.push_back(advance(e, 1, starts[e]));
    if (std::abs(pieces_[e].begin + pieces_[e].length - span_.anchor) < closest_cuts) {
      anchor = starts.back().point;
    }
  }
  SpanSamples samples;
  const auto count = static_cast<Eigen::Index>(s.size());
  samples.points.resize(3, count);
  samples.tangents.resize(3, count);
  samples.curvature.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double at = s[static_cast<std::size_t>(i)];
    std::size_t e = 0;
    while (e + 1 < pieces_.size() && at > pieces_[e].begin + pieces_[e].length) ++e;
    const double xi = std::clamp((at - pieces_[e].begin) / pieces_[e].length, 0.0, 1.0);
    const State state = advance(e, xi, starts[e]);
    samples.points.col(i) = state.point - anchor;
    samples.tangents.col(i) = state.tangent();
    const double cb = std::cos(state.beta);
    const Eigen::Vector3d t_theta(-cb * std::sin(state.theta), cb * std::cos(state.theta), 0);
    const Eigen::Vector3d t_beta(-std::sin(state.beta) * std::cos(state.theta),
                                 -std::sin(state.beta) * std::sin(state.theta), cb);
    samples.curvature.col(i) = state.kappa_theta * t_theta + state.kappa_beta * t_beta;
  }
  return samples;
}

Energies SpanEnergy::energies(const Eigen::VectorXd& x) {
  Eigen::VectorXd gradient(x.size());
  (void)value(x, gradient);
  Energies energies;
  const Eigen::VectorXd squares = x.cwiseAbs2();
  energies.bending = squares.sum() / 2;
  if (!span_.start_direction) {
    energies.bending -= squares[0] / 2;
    if (fields_ == 2) energies.bending -= squares[columns_] / 2;
  }
  if (fields_ == 2) {
    energies.bending -=
        (weights_.array() * t_.row(2).transpose().array().square() * kappa_.array().square())
            .sum() /
        2;
  }
  std::vector<double> at;
  for (const Span::Load& load : span_.loads) at.push_back(load.at);
  const SpanSamples samples = sample(x, at);
  for (std::size_t j = 0; j < span_.loads.size(); ++j) {
    energies.load -= span_.loads[j].force.dot(samples.points.col(static_cast<Eigen::Index>(j)));
  }
  energies.gravity = -force_.cwiseProduct(t_).sum() - energies.load;
  return energies;
}

void SpanEnergy::add_wall_terms(double& energy) {
  const Eigen::Matrix3Xd points = t_ * position_.transpose();
  for (std::size_t i = 0; i < span_.walls.size(); ++i) {
    const Span::Wall& wall = span_.walls[i];
    const auto column = static_cast<Eigen::Index>(i);
    const bool rigid = !std::isfinite(wall.stiffness);
    const double stiffness = rigid ? contact_stiffness_ : wall.stiffness;
    clearance_.col(column) = (wall.normal.transpose() * points).transpose().array() + wall.offset;
    // Augmented Lagrangian of a one-sided spring: p = max(0, lambda - k d), energy (p^2 -
    // lambda^2)/2k
    pressure_.col(column) =
        (contact_.col(column) - stiffness * clearance_.col(column)).cwiseMax(0.0);
    energy += (weights_.array() *
               (pressure_.col(column).array().square() - contact_.col(column).array().square()))
                  .sum() /
              (2 * stiffness);
    const Eigen::VectorXd push =
        position_.transpose() * weights_.cwiseProduct(pressure_.col(column));
    total_.noalias() += wall.normal * push.transpose();
  }
}

double SpanEnergy::update_contact() {
  double violation = 0;
  for (std::size_t i = 0; i < span_.walls.size(); ++i) {
    if (std::isfinite(span_.walls[i].stiffness)) continue;
    const auto column = static_cast<Eigen::Index>(i);
    const Eigen::VectorXd change = pressure_.col(column) - contact_.col(column);
    violation = std::max(violation, change.cwiseAbs().maxCoeff() / contact_stiffness_);
    contact_.col(column) = pressure_.col(column);
  }
  return violation;
}

std::vector<Eigen::Vector3d> SpanEnergy::wall_forces() const {
  std::vector<Eigen::Vector3d> forces;
  for (std::size_t i = 0; i < span_.walls.size(); ++i) {
    forces.emplace_back(weights_.dot(pressure_.col(static_cast<Eigen::Index>(i))) *
                        span_.walls[i].normal);
  }
  return forces;
}

Eigen::Vector3d SpanEnergy::end_torque(const Eigen::VectorXd& multipliers) const {
  if (!span_.end_direction) return Eigen::Vector3d::Zero();
  if (fields_ == 1) return {0, 0, multipliers[constraints_ - 1]};
  // Turning theta turns the tangent about z, turning beta about t x t_beta; there is no torque
  // about the tangent.
  const Eigen::Vector3d t = *span_.end_direction;
  const double cb = std::cos(end_beta_);
  const Eigen::Vector3d across(-std::sin(end_theta_), std::cos(end_theta_), 0);
  return multipliers[constraints_ - 2] / cb * t.cross(across) -
         multipliers[constraints_ - 1] * across;
}

Eigen::Vector3d SpanEnergy::start_torque(const Eigen::VectorXd& multipliers) const {
  if (!span_.start_direction) return Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = end_torque(multipliers);
  for (Eigen::Index j = 0; j < reach_.cols(); ++j) {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    force.head(axes_) = multipliers.segment(j * axes_, axes_);
    moment += span_.holds[static_cast<std::size_t>(j)].offset.cross(force);
  }
  const Eigen::VectorXd beyond = weights_.array() * (span_.length - s_.array());
  const Eigen::Vector3d first_moment = t_ * beyond;
  moment += first_moment.cross(span_.weight);
  for (const Span::Load& load : span_.loads) {
    const Eigen::VectorXd before =
        (s_.array() < load.at).select(weights_, Eigen::VectorXd::Zero(weights_.size()));
    const Eigen::Vector3d point = t_ * before;
    moment += point.cross(load.force);
  }
  if (has_walls()) {
    const Eigen::Matrix3Xd points = t_ * position_.transpose();
    for (std::size_t i = 0; i < span_.walls.size(); ++i) {
      const Eigen::Vector3d lever =
          points * weights_.cwiseProduct(pressure_.col(static_cast<Eigen::Index>(i)));
      moment += lever.cross(span_.walls[i].normal);
    }
  }
  return -moment;
}

}  // namespace dlo::energy_model
