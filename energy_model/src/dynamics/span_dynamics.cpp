#include "dynamics/span_dynamics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "vibration/span_motion.hpp"

namespace dlo::energy_model {
namespace {

/// Row by row.
Eigen::MatrixX3d cross_rows(const Eigen::MatrixX3d& a, const Eigen::MatrixX3d& b) {
  Eigen::MatrixX3d result(a.rows(), 3);
  result.col(0) = a.col(1).cwiseProduct(b.col(2)) - a.col(2).cwiseProduct(b.col(1));
  result.col(1) = a.col(2).cwiseProduct(b.col(0)) - a.col(0).cwiseProduct(b.col(2));
  result.col(2) = a.col(0).cwiseProduct(b.col(1)) - a.col(1).cwiseProduct(b.col(0));
  return result;
}

/// The piece's end, by number, that an arc length is; pieces end at all grips, loads and masses.
std::size_t station_at(const std::vector<Piece>& pieces, double s) {
  std::size_t nearest = 0;
  double distance = std::abs(s - pieces.front().begin);
  for (std::size_t e = 0; e < pieces.size(); ++e) {
    if (std::abs(pieces[e].end() - s) >= distance) continue;
    distance = std::abs(pieces[e].end() - s);
    nearest = e + 1;
  }
  return nearest;
}

}  // namespace

SpanDynamics::SpanDynamics(Span span, std::vector<Piece> pieces, int terms, bool planar,
                           const Eigen::Vector3d& first, SpanInertia inertia,
                           const ContactLaw& contact)
    : span_(std::move(span)),
      pieces_(std::move(pieces)),
      terms_(terms),
      planar_(planar),
      free_start_(!span_.start_direction),
      inertia_(std::move(inertia)),
      table_(&director_table(terms)),
      grid_(span_.rigid_obstacles, pieces_, *table_, contact),
      axes_(planar ? 2 : 3) {
  // In the plane d1 is across it, so that the first strain bends the rod within it.
  const Eigen::Vector3d tangent = span_.start_direction.value_or(first).normalized();
  const Eigen::Vector3d d1 = planar ? Eigen::Vector3d::UnitZ() : Span::d1(tangent);
  start_frame_ << d1, tangent.cross(d1), tangent;
  frames_.reset(pieces_, terms_, start_frame_, free_start_, {});
  frames_.resize(state_);
  size_ = (planar ? 1 : 2) * frames_.columns();
  elastic_ = Eigen::VectorXd::Ones(size_);
  if (free_start_) {
    for (Eigen::Index f = 0; f * frames_.columns() < size_; ++f)
      elastic_[f * frames_.columns()] = 0;
  }
  const Eigen::Index Q = nodes_of_piece();
  s_.resize(static_cast<Eigen::Index>(pieces_.size()) * Q);
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    s_.segment(static_cast<Eigen::Index>(e) * Q, Q) =
        pieces_[e].begin + (pieces_[e].length * table_->nodes).array();
  }
  anchor_station_ = station_at(pieces_, span_.anchor);
  for (const Span::Hold& hold : span_.holds) hold_stations_.push_back(station_at(pieces_, hold.at));
  constraints_ = axes_ * static_cast<Eigen::Index>(span_.holds.size());
  if (span_.end_direction) constraints_ += planar ? 1 : 2;
  station_loads_.assign(pieces_.size() + 1, Eigen::Vector3d::Zero());
  for (const Span::Load& load : span_.loads) {
    station_loads_[station_at(pieces_, load.at)] += load.force;
  }
  pushed_.assign(span_.soft_obstacles.size(), Eigen::Vector3d::Zero());
}

Eigen::VectorXd SpanDynamics::full(const Eigen::Ref<const Eigen::VectorXd>& part) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(2 * frames_.columns());
  result.head(size_) = part;
  return result;
}

/// Rates of the strains, turned into space, from rates of the unknowns.
Eigen::MatrixX3d SpanDynamics::rates(const Eigen::VectorXd& full) const {
  const Eigen::Index turns = frames_.turn_nodes();
  const Eigen::Index Q = nodes_of_piece();
  Eigen::MatrixX3d result = Eigen::MatrixX3d::Zero(state_.t.rows(), 3);
  for (Eigen::Index field = 0; field < 2; ++field) {
    const Eigen::Index first = field * frames_.columns();
    const Eigen::MatrixX3d& d = field == 0 ? state_.d1 : state_.d2;
    if (turns > 0) result.topRows(turns) += full[first] * d.topRows(turns);
    for (std::size_t e = 0; e < pieces_.size(); ++e) {
      const auto piece = static_cast<Eigen::Index>(e);
      const Eigen::VectorXd strains =
          pieces_[e].strain(field) *
          (table_->values.leftCols(terms_) *
           full.segment(first + (turns > 0 ? 1 : 0) + piece * terms_, terms_));
      const Eigen::Index row = turns + piece * Q;
      result.middleRows(row, Q) += strains.asDiagonal() * d.middleRows(row, Q);
    }
  }
  return result;
}

void SpanDynamics::move(const SpanDrive& drive, const Eigen::Ref<const Eigen::VectorXd>& x,
                        const Eigen::Ref<const Eigen::VectorXd>& v,
                        const Eigen::Ref<const Eigen::VectorXd>& a) {
  drive_ = drive;
  x_ = x;
  v_ = v;
  frames_.evaluate(full(x), state_);
  const Eigen::Index turns = frames_.turn_nodes();
  const Eigen::Index Q = nodes_of_piece();
  const Eigen::MatrixX3d spun = rates(full(v));
  Eigen::MatrixX3d spun_on = rates(full(a));
  omega_.resize(spun.rows(), 3);
  alpha_.resize(spun.rows(), 3);
  Eigen::RowVector3d omega = drive.spin.transpose();
  Eigen::RowVector3d alpha = drive.spin_rate.transpose();
  const auto integrate = [&](const LegendreTable& table, Eigen::Index row, double length) {
    const Eigen::Index rows = table.nodes.size();
    omega_.middleRows(row, rows) = length * (table.integration * spun.middleRows(row, rows));
    omega_.middleRows(row, rows).rowwise() += omega;
    omega += length * (table.weights.transpose() * spun.middleRows(row, rows));
    spun_on.middleRows(row, rows) +=
        cross_rows(omega_.middleRows(row, rows), spun.middleRows(row, rows));
    alpha_.middleRows(row, rows) = length * (table.integration * spun_on.middleRows(row, rows));
    alpha_.middleRows(row, rows).rowwise() += alpha;
    alpha += length * (table.weights.transpose() * spun_on.middleRows(row, rows));
  };
  if (turns > 0) integrate(director_table(1), 0, 1);
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    integrate(*table_, turns + static_cast<Eigen::Index>(e) * Q, pieces_[e].length);
  }
  const Eigen::Index nodes = s_.size();
  const Eigen::MatrixX3d t = state_.t.bottomRows(nodes);
  const Eigen::MatrixX3d w = omega_.bottomRows(nodes);
  t_rate_ = cross_rows(w, t);
  const Eigen::MatrixX3d t_acceleration =
      cross_rows(alpha_.bottomRows(nodes), t) + cross_rows(w, t_rate_);
  end_tangent_.value = state_.end_frame().col(2);
  end_tangent_.rate = Eigen::Vector3d(omega.transpose()).cross(end_tangent_.value);
  end_tangent_.acceleration = Eigen::Vector3d(alpha.transpose()).cross(end_tangent_.value) +
                              Eigen::Vector3d(omega.transpose()).cross(end_tangent_.rate);

  position_.resize(nodes, 3);
  velocity_.resize(nodes, 3);
  acceleration_.resize(nodes, 3);
  stations_.assign(pieces_.size() + 1, {});
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * Q;
    const auto along = [&](const Eigen::MatrixX3d& of, const Eigen::Vector3d& begin,
                           Eigen::MatrixX3d& into) {
      into.middleRows(row, Q) = pieces_[e].length * (table_->integration * of.middleRows(row, Q));
      into.middleRows(row, Q).rowwise() += begin.transpose();
      return Eigen::Vector3d(begin + pieces_[e].length *
                                         (of.middleRows(row, Q).transpose() * table_->weights));
    };
    stations_[e + 1].value = along(t, stations_[e].value, position_);
    stations_[e + 1].rate = along(t_rate_, stations_[e].rate, velocity_);
    stations_[e + 1].acceleration = along(t_acceleration, stations_[e].acceleration, acceleration_);
  }
  const Moving shift = {drive.anchor.value - stations_[anchor_station_].value,
                        drive.anchor.rate - stations_[anchor_station_].rate,
                        drive.anchor.acceleration - stations_[anchor_station_].acceleration};
  position_.rowwise() += shift.value.transpose();
  velocity_.rowwise() += shift.rate.transpose();
  acceleration_.rowwise() += shift.acceleration.transpose();
  for (Moving& station : stations_) {
    station.value += shift.value;
    station.rate += shift.rate;
    station.acceleration += shift.acceleration;
  }
  collect_forces();
}

/// Of nodes and stations: inertia and drag, less weight, loads and what obstacles push with.
void SpanDynamics::collect_forces() {
  const Eigen::Index Q = nodes_of_piece();
  forces_.resize(s_.size(), 3);
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * Q;
    const Piece& piece = pieces_[e];
    const Eigen::Vector3d weight =
        drive_.turn * span_.weight_between(piece.begin, piece.end()) / piece.length;
    forces_.middleRows(row, Q) = inertia_.per_length[e] * acceleration_.middleRows(row, Q) +
                                 inertia_.drag * velocity_.middleRows(row, Q);
    forces_.middleRows(row, Q).rowwise() -= weight.transpose();
    forces_.middleRows(row, Q).array().colwise() *= piece.length * table_->weights.array();
  }
  station_forces_.resize(stations_.size());
  for (std::size_t k = 0; k < stations_.size(); ++k) {
    station_forces_[k] =
        inertia_.at_stations[k] * stations_[k].acceleration - drive_.turn * station_loads_[k];
  }
  collect_soft_obstacles();
  collect_touches();
}

Eigen::Vector3d SpanDynamics::multiplier_force(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                               std::size_t hold) const {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  force.head(axes_) = multipliers.segment(axes_ * static_cast<Eigen::Index>(hold), axes_);
  return force;
}

/// Work of forces at nodes, stations and points of the grid, by the tangents at the nodes: the
/// internal force that they ask for.
Eigen::MatrixX3d SpanDynamics::by_tangents(const Eigen::MatrixX3d& at_nodes,
                                           const std::vector<Eigen::Vector3d>& at_stations,
                                           const std::vector<GridForce>& at_grid) const {
  const Eigen::Index Q = nodes_of_piece();
  Eigen::Vector3d all = at_nodes.colwise().sum().transpose();
  for (const Eigen::Vector3d& force : at_stations) all += force;
  for (const GridForce& at : at_grid) all += at.force;
  // Gradient by the tangents: what a tangent moves is all that lies beyond, seen from the anchor.
  Eigen::MatrixX3d result(s_.size(), 3);
  Eigen::Vector3d beyond = Eigen::Vector3d::Zero();
  for (std::size_t e = pieces_.size(); e-- > 0;) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * Q;
    beyond += at_stations[e + 1];
    const Eigen::Vector3d carried = e < anchor_station_ ? Eigen::Vector3d(beyond - all) : beyond;
    result.middleRows(row, Q) =
        pieces_[e].length * (table_->integration.transpose() * at_nodes.middleRows(row, Q) +
                             table_->weights * carried.transpose());
    beyond += at_nodes.middleRows(row, Q).colwise().sum().transpose();
    for (const GridForce& at : at_grid) {
      if (at.piece != e) continue;
      result.middleRows(row, Q) +=
          pieces_[e].length * grid_.place(e, at.point) * at.force.transpose();
      beyond += at.force;
    }
  }
  return result;
}

/// The same, and of couples at the pieces' ends, by the unknowns.
Eigen::VectorXd SpanDynamics::pulled(const Eigen::MatrixX3d& tangents,
                                     const std::vector<Eigen::Vector3d>& couples) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(2 * frames_.columns());
  frames_.pull({&tangents, couples}, 1, state_, result);
  return result.head(size_);
}

/// Of all that acts on the rod, with these multipliers, by the tangents.
Eigen::MatrixX3d SpanDynamics::all_by_tangents(
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  std::vector<Eigen::Vector3d> at_stations = station_forces_;
  for (std::size_t k = 0; k < hold_stations_.size(); ++k) {
    at_stations[hold_stations_[k]] -= multiplier_force(multipliers, k);
  }
  std::vector<GridForce> at_grid;
  for (const Touch& touch : touches_) {
    at_grid.push_back({touch.piece, touch.point, -touch.push * touch.normal});
  }
  return by_tangents(forces_, at_stations, at_grid);
}

/// The clamp's at the end, by piece.
std::vector<Eigen::Vector3d> SpanDynamics::couples(
    const Eigen::Ref<const Eigen::VectorXd>& multipliers) const {
  std::vector<Eigen::Vector3d> result(pieces_.size(), Eigen::Vector3d::Zero());
  const Eigen::Index first = axes_ * static_cast<Eigen::Index>(hold_stations_.size());
  for (std::size_t i = 0; i < drive_.across_end.size(); ++i) {
    result.back() -= multipliers[first + static_cast<Eigen::Index>(i)] *
                     end_tangent_.value.cross(drive_.across_end[i].value);
  }
  return result;
}

Eigen::VectorXd SpanDynamics::residual(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  return elastic_.cwiseProduct(x_ + inertia_.material_damping * v_) +
         pulled(all_by_tangents(multipliers), couples(multipliers));
}

/// Of the internal force, which keeps its direction as the tangents turn: nearly all of the
/// stiffness of a thread under tension T, where bending has a share of EI / (T l^2).
void SpanDynamics::add_geometric_stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                           Eigen::MatrixXd& stiffness) {
  const Eigen::MatrixX3d tangents = all_by_tangents(multipliers);
  std::vector<Eigen::Matrix3d> curvatures(pieces_.size(), Eigen::Matrix3d::Zero());
  const Eigen::Index first = axes_ * static_cast<Eigen::Index>(hold_stations_.size());
  const Eigen::Vector3d& t = end_tangent_.value;
  for (std::size_t i = 0; i < drive_.across_end.size(); ++i) {
    const Eigen::Vector3d& e = drive_.across_end[i].value;
    const Eigen::Matrix3d turned = (e * t.transpose() + t * e.transpose()) / 2;
    curvatures.back() -= multipliers[first + static_cast<Eigen::Index>(i)] *
                         (turned - e.dot(t) * Eigen::Matrix3d::Identity());
  }
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(2 * frames_.columns(), 2 * frames_.columns());
  frames_.add_hessian({&tangents, couples(multipliers)}, curvatures, state_, hessian);
  stiffness += hessian.topLeftCorner(size_, size_);
}

SpanVelocities SpanDynamics::velocities() const {
  SpanVelocities result{velocity_, {}};
  for (const Moving& station : stations_) result.stations.push_back(station.rate);
  return result;
}

Eigen::VectorXd SpanDynamics::impulse(const SpanVelocities& before) {
  const Eigen::Index Q = nodes_of_piece();
  Eigen::MatrixX3d at_nodes = velocity_ - before.nodes;
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    at_nodes.middleRows(static_cast<Eigen::Index>(e) * Q, Q).array().colwise() *=
        inertia_.per_length[e] * pieces_[e].length * table_->weights.array();
  }
  std::vector<Eigen::Vector3d> at_stations;
  for (std::size_t k = 0; k < stations_.size(); ++k) {
    at_stations.emplace_back(inertia_.at_stations[k] * (stations_[k].rate - before.stations[k]));
  }
  return pulled(by_tangents(at_nodes, at_stations, {}), {});
}

Eigen::MatrixX3d SpanDynamics::misses() const {
  Eigen::MatrixX3d result(constraints_, 3);
  for (std::size_t k = 0; k < hold_stations_.size(); ++k) {
    const Moving& has = stations_[hold_stations_[k]];
    const Moving& wanted = drive_.holds[k];
    const Eigen::Index row = axes_ * static_cast<Eigen::Index>(k);
    result.col(0).segment(row, axes_) = (has.value - wanted.value).head(axes_);
    result.col(1).segment(row, axes_) = (has.rate - wanted.rate).head(axes_);
    result.col(2).segment(row, axes_) = (has.acceleration - wanted.acceleration).head(axes_);
  }
  Eigen::Index row = axes_ * static_cast<Eigen::Index>(hold_stations_.size());
  const Moving& t = end_tangent_;
  for (const Moving& e : drive_.across_end) {
    result(row, 0) = e.value.dot(t.value);
    result(row, 1) = e.rate.dot(t.value) + e.value.dot(t.rate);
    result(row, 2) =
        e.acceleration.dot(t.value) + 2 * e.rate.dot(t.rate) + e.value.dot(t.acceleration);
    ++row;
  }
  return result;
}

Eigen::MatrixXd SpanDynamics::jacobian() {
  Eigen::MatrixXd result(constraints_, size_);
  for (std::size_t k = 0; k < hold_stations_.size(); ++k) {
    std::vector<double> signs(pieces_.size(), 0);
    for (std::size_t e = 0; e < signs.size(); ++e) {
      signs[e] = (e < hold_stations_[k] ? 1 : 0) - (e < anchor_station_ ? 1 : 0);
    }
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, 2 * frames_.columns());
    frames_.pull_position(signs, state_, rows);
    result.middleRows(axes_ * static_cast<Eigen::Index>(k), axes_) =
        rows.topLeftCorner(axes_, size_);
  }
  Eigen::Index row = axes_ * static_cast<Eigen::Index>(hold_stations_.size());
  for (const Moving& e : drive_.across_end) {
    std::vector<Eigen::Vector3d> couples(pieces_.size(), Eigen::Vector3d::Zero());
    couples.back() = end_tangent_.value.cross(e.value);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(2 * frames_.columns());
    frames_.pull({nullptr, couples}, 1, state_, gradient);
    result.row(row++) = gradient.head(size_).transpose();
  }
  return result;
}

Eigen::MatrixXd SpanDynamics::mass_matrix() {
  std::array<Eigen::MatrixXd, 3> tangents = frames_.tangent_jacobian(state_);
  for (Eigen::MatrixXd& axis : tangents) axis = axis.leftCols(size_).eval();
  const SpanMotion motion(pieces_, *table_, span_.anchor, std::move(tangents));
  std::vector<SpanMass> points;
  for (std::size_t k = 0; k < stations_.size(); ++k) {
    if (inertia_.at_stations[k] == 0) continue;
    const double s = k == 0 ? pieces_.front().begin : pieces_[k - 1].end();
    points.push_back({s, inertia_.at_stations[k]});
  }
  const std::array<Eigen::MatrixXd, 3> masses = motion.masses(
      [&](Eigen::Index e) { return inertia_.per_length[static_cast<std::size_t>(e)]; }, points);
  return masses[0] + masses[1] + masses[2];
}

Eigen::VectorXd SpanDynamics::fit(const Eigen::Matrix3Xd& tangents) const {
  return frames_.fit(tangents).head(size_);
}

SpanShape SpanDynamics::shape(const Eigen::VectorXd& x) const {
  SpanShape result;
  result.terms = terms_;
  result.planar = false;
  result.anchor = span_.anchor;
  result.pieces = pieces_;
  result.start_frame = start_frame_;
  result.free_start = free_start_;
  result.strains = full(x);
  return result;
}

}  // namespace dlo::energy_model
