// What obstacles do to a moving span: those that yield at its nodes, rigid ones at the grid's
// points.

#include <algorithm>

#include "dynamics/span_dynamics.hpp"

namespace dlo::energy_model {

void SpanDynamics::collect_soft_obstacles() {
  const Eigen::Index Q = nodes_of_piece();
  obstacle_energy_ = 0;
  obstacle_work_ = 0;
  for (std::size_t i = 0; i < span_.soft_obstacles.size(); ++i) {
    const Span::SoftObstacle& obstacle = span_.soft_obstacles[i];
    const BodyPlace& place = drive_.soft_obstacles[i];
    pushed_[i].setZero();
    for (Eigen::Index node = 0; node < s_.size(); ++node) {
      const Eigen::Vector3d at = place.inside(position_.row(node).transpose());
      if (!(obstacle.body.clearance(at) < 0)) continue;
      const obstacle::Gap gap = obstacle.body.gap(at);
      const double weight =
          pieces_[static_cast<std::size_t>(node / Q)].length * table_->weights[node % Q];
      const Eigen::Vector3d push =
          place.turn * (-obstacle.stiffness * weight * gap.value * gap.gradient);
      obstacle_energy_ += obstacle.stiffness * weight * gap.value * gap.value / 2;
      obstacle_work_ += push.dot(place.velocity_at(position_.row(node).transpose()));
      pushed_[i] += push;
      forces_.row(node) -= push.transpose();
    }
  }
}

void SpanDynamics::collect_touches() {
  touches_.clear();
  if (grid_.empty()) return;
  const Eigen::Index Q = nodes_of_piece();
  for (std::size_t e = 0; e < pieces_.size(); ++e) {
    const Eigen::Index row = static_cast<Eigen::Index>(e) * Q;
    const double length = pieces_[e].length;
    const Eigen::MatrixX3d along =
        length * state_.t.middleRows(state_.t.rows() - s_.size() + row, Q);
    const auto first = static_cast<std::ptrdiff_t>(touches_.size());
    for (std::size_t i = 0; i < span_.rigid_obstacles.size(); ++i) {
      Touch of;
      of.obstacle = i;
      of.piece = e;
      grid_.find(span_.rigid_obstacles[i].body, drive_.rigid_obstacles[i], of, stations_[e].value,
                 along, touches_);
    }
    std::for_each(touches_.begin() + first, touches_.end(), [&](Touch& touch) {
      const Eigen::Vector3d velocity =
          stations_[e].rate +
          length * (t_rate_.middleRows(row, Q).transpose() * grid_.place(e, touch.point));
      grid_.resist(-touch.normal.dot(velocity - touch.velocity), touch);
    });
  }
}

/// By the unknowns.
Eigen::VectorXd SpanDynamics::depth_gradient(const Touch& touch) {
  return pulled(by_tangents(Eigen::MatrixX3d::Zero(s_.size(), 3),
                            std::vector<Eigen::Vector3d>(stations_.size(), Eigen::Vector3d::Zero()),
                            {{touch.piece, touch.point, -touch.normal}}),
                {});
}

Eigen::MatrixXd SpanDynamics::stiffness(const Eigen::Ref<const Eigen::VectorXd>& multipliers) {
  Eigen::MatrixXd result = elastic_.asDiagonal();
  add_geometric_stiffness(multipliers, result);
  for (const Touch& touch : touches_) {
    const Eigen::VectorXd gradient = depth_gradient(touch);
    result += touch.by_depth * gradient * gradient.transpose();
  }
  return result;
}

Eigen::MatrixXd SpanDynamics::damping(const Eigen::MatrixXd& mass) {
  // Drag acts as masses do, where those are the same all along.
  double rod = 0;
  for (std::size_t e = 0; e < pieces_.size(); ++e)
    rod += inertia_.per_length[e] * pieces_[e].length;
  Eigen::MatrixXd result = (rod > 0 ? inertia_.drag * span_.length / rod : 0) * mass;
  result.diagonal() += inertia_.material_damping * elastic_;
  for (const Touch& touch : touches_) {
    const Eigen::VectorXd gradient = depth_gradient(touch);
    result += touch.by_rate * gradient * gradient.transpose();
  }
  return result;
}

std::vector<Eigen::Vector3d> SpanDynamics::rigid_forces() const {
  std::vector<Eigen::Vector3d> result(span_.rigid_obstacles.size(), Eigen::Vector3d::Zero());
  for (const Touch& touch : touches_) result[touch.obstacle] += touch.push * touch.normal;
  return result;
}

double SpanDynamics::depth() const {
  double result = 0;
  for (const Touch& touch : touches_) result = std::max(result, touch.depth);
  return result;
}

}  // namespace dlo::energy_model
