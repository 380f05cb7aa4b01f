#include "frames/position_operator.hpp"

#include <utility>

namespace dlo::energy_model {

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

Eigen::VectorXd PointsReach::weights(Eigen::Index point) const {
  Eigen::VectorXd result = begin_;
  result.segment(first_, own_.rows()) += own_.col(point);
  return result;
}

void tabulate_nodes(const std::vector<Piece>& pieces, const LegendreTable& table,
                    Eigen::VectorXd& nodes, Eigen::VectorXd& weights) {
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index count = std::ssize(pieces);
  nodes.resize(count * Q);
  weights.resize(count * Q);
  for (Eigen::Index e = 0; e < count; ++e) {
    const Piece& piece = pieces[static_cast<std::size_t>(e)];
    nodes.segment(e * Q, Q) = piece.begin + piece.length * table.nodes.array();
    weights.segment(e * Q, Q) = piece.length * table.weights;
  }
}

PositionOperator::PositionOperator(const Span& span, std::vector<Piece> pieces,
                                   const LegendreTable& table)
    : pieces_(std::move(pieces)), table_(&table), anchor_(span.anchor) {
  tabulate_nodes(pieces_, table, nodes_, weights_);
  to_anchor_ = (nodes_.array() < anchor_).select(weights_, Eigen::VectorXd::Zero(nodes_.size()));
}

std::vector<double> PositionOperator::signs(double s) const {
  std::vector<double> result(pieces_.size(), 0);
  const auto before = static_cast<std::size_t>(pieces_before(pieces_, s));
  const auto anchor = static_cast<std::size_t>(pieces_before(pieces_, anchor_));
  for (std::size_t e = anchor; e < before; ++e) result[e] = 1;
  for (std::size_t e = before; e < anchor; ++e) result[e] = -1;
  return result;
}

Eigen::VectorXd PositionOperator::begin(Eigen::Index piece) const {
  Eigen::VectorXd reach = -to_anchor_;
  const Eigen::Index before = piece * table_->nodes.size();
  reach.head(before) += weights_.head(before);
  return reach;
}

PointsReach PositionOperator::at_begin(Eigen::Index piece) const {
  return {begin(piece), 0, Eigen::MatrixXd::Zero(0, 1)};
}

PointsReach PositionOperator::along(Eigen::Index piece) const {
  const Eigen::Index Q = table_->nodes.size();
  const Eigen::Index first = piece * Q;
  Eigen::MatrixXd own(Q, Q + 2);
  own << Eigen::VectorXd::Zero(Q),
      pieces_[static_cast<std::size_t>(piece)].length * table_->integration.transpose(),
      weights_.segment(first, Q);
  return {begin(piece), first, std::move(own)};
}

Eigen::VectorXd PositionOperator::at(double s) const {
  const auto ends_before = [s](const Piece& piece) { return piece.end() <= s; };
  const Eigen::Index piece = std::min<Eigen::Index>(
      std::count_if(pieces_.begin(), pieces_.end(), ends_before), std::ssize(pieces_) - 1);
  return at(piece, s).position;
}

PositionOperator::Point PositionOperator::at(Eigen::Index piece, double s) const {
  const Eigen::Index Q = table_->nodes.size();
  const Piece& own = pieces_[static_cast<std::size_t>(piece)];
  const double xi = (s - own.begin) / own.length;
  Eigen::MatrixXd of_terms(Q, 3);
  legendre(xi, of_terms.col(1), of_terms.col(0));
  legendre_slopes(xi, of_terms.col(2));
  // Weights of the element's nodes in functionals of the Legendre series through their values.
  const Eigen::MatrixXd weights = table_->weights.asDiagonal() * (table_->values * of_terms);
  Point point;
  point.position = begin(piece);
  point.position.segment(piece * Q, Q) += own.length * weights.col(0);
  point.tangent = point.curvature = Eigen::VectorXd::Zero(weights_.size());
  point.tangent.segment(piece * Q, Q) = weights.col(1);
  point.curvature.segment(piece * Q, Q) = weights.col(2) / own.length;
  return point;
}

SpanReach::SpanReach(const PositionOperator& reach) : nodes_(reach.nodes().size()) {
  const Eigen::Index count = std::ssize(reach.pieces());
  const Eigen::Index Q = nodes_ / count;
  weights_.setZero(count * (Q + 2));
  for (Eigen::Index e = 0; e < count; ++e) {
    pieces_.push_back(reach.along(e));
    weights_.segment(e * (Q + 2) + 1, Q) = reach.weights().segment(e * Q, Q);
  }
}

Eigen::VectorXd SpanReach::weighed(const std::vector<double>& per_length) const {
  Eigen::VectorXd result = weights_;
  for (std::size_t e = 0; e < per_length.size(); ++e) {
    result.segment(begin(static_cast<Eigen::Index>(e)), piece_points()) *= per_length[e];
  }
  return result;
}

Eigen::MatrixXd SpanReach::sums(const Eigen::MatrixXd& by_node) const {
  Eigen::MatrixXd result(points(), by_node.cols());
  for (Eigen::Index e = 0; e < std::ssize(pieces_); ++e) {
    result.middleRows(begin(e), piece_points()) =
        pieces_[static_cast<std::size_t>(e)].sums(by_node);
  }
  return result;
}

Eigen::MatrixXd SpanReach::spread(const Eigen::MatrixXd& by_point) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(nodes_, by_point.cols());
  Eigen::MatrixXd of_piece(nodes_, by_point.cols());
  for (Eigen::Index e = 0; e < std::ssize(pieces_); ++e) {
    pieces_[static_cast<std::size_t>(e)].spread(by_point.middleRows(begin(e), piece_points()),
                                                of_piece);
    result += of_piece;
  }
  return result;
}

}  // namespace dlo::energy_model
