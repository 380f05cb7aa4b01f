#include "strain/node_reach.hpp"

#include <utility>

namespace dlo::energy_model {

Eigen::Matrix3Xd PointsReach::positions(const Eigen::MatrixX3d& tangents) const {
  Eigen::Matrix3Xd result = tangents.middleRows(first_, own_.rows()).transpose() * own_;
  result.colwise() += Eigen::Vector3d(tangents.transpose() * begin_);
  return result;
}

Eigen::MatrixXd PointsReach::sums(const Eigen::MatrixXd& by_node) const {
  Eigen::MatrixXd result = own_.transpose() * by_node.middleRows(first_, own_.rows());
  result.rowwise() += Eigen::RowVectorXd(begin_.transpose() * by_node);
  return result;
}

void PointsReach::spread(const Eigen::MatrixXd& by_point,
                         Eigen::Ref<Eigen::MatrixXd> by_node) const {
  by_node.noalias() = begin_ * by_point.colwise().sum();
  by_node.middleRows(first_, own_.rows()).noalias() += own_ * by_point;
}

NodeReach::NodeReach(const Span& span, std::vector<Piece> pieces, const LegendreTable& table,
                     const Eigen::VectorXd& nodes, const Eigen::VectorXd& weights)
    : pieces_(std::move(pieces)),
      table_(&table),
      weights_(weights),
      to_anchor_(
          (nodes.array() < span.anchor).select(weights, Eigen::VectorXd::Zero(nodes.size()))) {}

Eigen::VectorXd NodeReach::begin(Eigen::Index piece) const {
  Eigen::VectorXd reach = -to_anchor_;
  const Eigen::Index before = piece * table_->nodes.size();
  reach.head(before) += weights_.head(before);
  return reach;
}

Eigen::MatrixXd NodeReach::of_nodes(Eigen::Index piece) const {
  const Eigen::Index Q = table_->nodes.size();
  Eigen::MatrixXd reach = begin(piece).replicate(1, Q);
  const double length = pieces_[static_cast<std::size_t>(piece)].length;
  reach.middleRows(piece * Q, Q) += length * table_->integration.transpose();
  return reach;
}

PointsReach NodeReach::at_begin(Eigen::Index piece) const {
  return {begin(piece), 0, Eigen::MatrixXd::Zero(0, 1)};
}

PointsReach NodeReach::along(Eigen::Index piece) const {
  const Eigen::Index Q = table_->nodes.size();
  const Eigen::Index first = piece * Q;
  Eigen::MatrixXd own(Q, Q + 2);
  own << Eigen::VectorXd::Zero(Q),
      pieces_[static_cast<std::size_t>(piece)].length * table_->integration.transpose(),
      weights_.segment(first, Q);
  return {begin(piece), first, std::move(own)};
}

NodeReach::Point NodeReach::at(Eigen::Index piece, double s) const {
  const Eigen::Index Q = table_->nodes.size();
  const Piece& own = pieces_[static_cast<std::size_t>(piece)];
  const double xi = (s - own.begin) / own.length;
  Eigen::VectorXd values(Q);
  Eigen::VectorXd integrals(Q);
  Eigen::VectorXd slopes(Q);
  legendre(xi, values, integrals);
  legendre_slopes(xi, slopes);
  // Of the polynomial through what is given at the nodes.
  const auto through = [&](const Eigen::VectorXd& of_terms) -> Eigen::VectorXd {
    return table_->weights.cwiseProduct(table_->values * of_terms);
  };
  Point point;
  point.position = begin(piece);
  point.position.segment(piece * Q, Q) += own.length * through(integrals);
  point.tangent = point.curvature = Eigen::VectorXd::Zero(weights_.size());
  point.tangent.segment(piece * Q, Q) = through(values);
  point.curvature.segment(piece * Q, Q) = through(slopes) / own.length;
  return point;
}

}  // namespace dlo::energy_model
