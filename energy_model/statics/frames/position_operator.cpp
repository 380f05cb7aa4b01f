#include "frames/position_operator.hpp"

#include <utility>

namespace dlo::energy_model {

Eigen::MatrixXd PointOperator::to_points(const Eigen::MatrixXd& by_node) const {
  Eigen::MatrixXd result = own_.transpose() * by_node.middleRows(first_, own_.rows());
  result.rowwise() += Eigen::RowVectorXd(begin_.transpose() * by_node);
  return result;
}

void PointOperator::to_nodes(const Eigen::MatrixXd& by_point,
                             Eigen::Ref<Eigen::MatrixXd> by_node) const {
  by_node.noalias() = begin_ * by_point.colwise().sum();
  by_node.middleRows(first_, own_.rows()).noalias() += own_ * by_point;
}

Eigen::VectorXd PointOperator::weights(Eigen::Index point) const {
  Eigen::VectorXd result = begin_;
  result.segment(first_, own_.rows()) += own_.col(point);
  return result;
}

void tabulate_nodes(const std::vector<Element>& elements, const LegendreTable& table,
                    Eigen::VectorXd& nodes, Eigen::VectorXd& weights) {
  const Eigen::Index Q = table.nodes.size();
  const Eigen::Index count = std::ssize(elements);
  nodes.resize(count * Q);
  weights.resize(count * Q);
  for (Eigen::Index e = 0; e < count; ++e) {
    const Element& element = elements[static_cast<std::size_t>(e)];
    nodes.segment(e * Q, Q) = element.begin + element.length * table.nodes.array();
    weights.segment(e * Q, Q) = element.length * table.weights;
  }
}

PositionOperator::PositionOperator(const Span& span, std::vector<Element> elements,
                                   const LegendreTable& table)
    : elements_(std::move(elements)), table_(&table), anchor_(span.anchor) {
  tabulate_nodes(elements_, table, nodes_, weights_);
  to_anchor_ = (nodes_.array() < anchor_).select(weights_, Eigen::VectorXd::Zero(nodes_.size()));
}

std::vector<double> PositionOperator::signs(double s) const {
  std::vector<double> result(elements_.size(), 0);
  const auto before = static_cast<std::size_t>(elements_before(elements_, s));
  const auto anchor = static_cast<std::size_t>(elements_before(elements_, anchor_));
  for (std::size_t e = anchor; e < before; ++e) result[e] = 1;
  for (std::size_t e = before; e < anchor; ++e) result[e] = -1;
  return result;
}

Eigen::VectorXd PositionOperator::begin(Eigen::Index element) const {
  Eigen::VectorXd reach = -to_anchor_;
  const Eigen::Index before = element * table_->nodes.size();
  reach.head(before) += weights_.head(before);
  return reach;
}

/// Returns weights of an element's nodes in linear functionals of the Legendre series that
/// interpolates the values at the nodes.
/// @param of_terms  value of the functional for each polynomial
Eigen::MatrixXd PositionOperator::functional_weights(const Eigen::MatrixXd& of_terms) const {
  return table_->weights.asDiagonal() * (table_->values * of_terms);
}

PointOperator PositionOperator::points(Eigen::Index element, const Eigen::VectorXd& shares) const {
  const Eigen::Index Q = table_->nodes.size();
  Eigen::VectorXd values(Q);
  Eigen::MatrixXd integrals(Q, shares.size());
  for (Eigen::Index j = 0; j < shares.size(); ++j) legendre(shares[j], values, integrals.col(j));
  const double length = elements_[static_cast<std::size_t>(element)].length;
  return {begin(element), element * Q, length * functional_weights(integrals)};
}

PointOperator PositionOperator::along(Eigen::Index element) const {
  const Eigen::Index Q = table_->nodes.size();
  const Eigen::Index first = element * Q;
  Eigen::MatrixXd own(Q, Q + 2);
  own << Eigen::VectorXd::Zero(Q),
      elements_[static_cast<std::size_t>(element)].length * table_->integration.transpose(),
      weights_.segment(first, Q);
  return {begin(element), first, std::move(own)};
}

Eigen::VectorXd PositionOperator::at(double s) const {
  const auto ends_before = [s](const Element& element) { return element.end() <= s; };
  const Eigen::Index element = std::min<Eigen::Index>(std::ranges::count_if(elements_, ends_before),
                                                      std::ssize(elements_) - 1);
  const Element& own = elements_[static_cast<std::size_t>(element)];
  return points(element, Eigen::VectorXd::Constant(1, (s - own.begin) / own.length)).weights(0);
}

PositionOperator::Point PositionOperator::at(Eigen::Index element, double s) const {
  const Eigen::Index Q = table_->nodes.size();
  const Element& own = elements_[static_cast<std::size_t>(element)];
  const double xi = (s - own.begin) / own.length;
  Eigen::MatrixXd of_terms(Q, 3);
  legendre(xi, of_terms.col(1), of_terms.col(0));
  legendre_slopes(xi, of_terms.col(2));
  const Eigen::MatrixXd weights = functional_weights(of_terms);
  Point point;
  point.position = begin(element);
  point.position.segment(element * Q, Q) += own.length * weights.col(0);
  point.tangent = point.curvature = Eigen::VectorXd::Zero(weights_.size());
  point.tangent.segment(element * Q, Q) = weights.col(1);
  point.curvature.segment(element * Q, Q) = weights.col(2) / own.length;
  return point;
}

SpanPointOperator::SpanPointOperator(const PositionOperator& reach) : nodes_(reach.nodes().size()) {
  const Eigen::Index count = std::ssize(reach.elements());
  const Eigen::Index Q = nodes_ / count;
  weights_.setZero(count * (Q + 2));
  for (Eigen::Index e = 0; e < count; ++e) {
    elements_.push_back(reach.along(e));
    weights_.segment(e * (Q + 2) + 1, Q) = reach.weights().segment(e * Q, Q);
  }
}

Eigen::VectorXd SpanPointOperator::weights_with_density(
    const std::vector<double>& per_length) const {
  Eigen::VectorXd result = weights_;
  for (std::size_t e = 0; e < per_length.size(); ++e) {
    result.segment(begin(static_cast<Eigen::Index>(e)), element_points()) *= per_length[e];
  }
  return result;
}

Eigen::MatrixXd SpanPointOperator::to_points(const Eigen::MatrixXd& by_node) const {
  Eigen::MatrixXd result(points(), by_node.cols());
  for (Eigen::Index e = 0; e < std::ssize(elements_); ++e) {
    result.middleRows(begin(e), element_points()) =
        elements_[static_cast<std::size_t>(e)].to_points(by_node);
  }
  return result;
}

Eigen::MatrixXd SpanPointOperator::to_nodes(const Eigen::MatrixXd& by_point) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(nodes_, by_point.cols());
  Eigen::MatrixXd of_piece(nodes_, by_point.cols());
  for (Eigen::Index e = 0; e < std::ssize(elements_); ++e) {
    elements_[static_cast<std::size_t>(e)].to_nodes(by_point.middleRows(begin(e), element_points()),
                                                    of_piece);
    result += of_piece;
  }
  return result;
}

}  // namespace dlo::energy_model
