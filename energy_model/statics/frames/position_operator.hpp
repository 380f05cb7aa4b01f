#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Weights that give positions of several points of one element as sums over the tangents at the
/// span's nodes. The weights of other elements' nodes are the same for all of these points.
class PointOperator {
 public:
  PointOperator() = default;
  /// @param begin  weights of all nodes for the point where the element begins
  /// @param first  index of the element's first node
  /// @param own    weights of the element's own nodes for the vectors from its begin to the points,
  ///   nodes x points
  PointOperator(Eigen::VectorXd begin, Eigen::Index first, Eigen::MatrixXd own)
      : begin_(std::move(begin)), first_(first), own_(std::move(own)) {}

  [[nodiscard]] Eigen::Index points() const { return own_.cols(); }
  /// Returns the weights of all nodes for one point.
  [[nodiscard]] Eigen::VectorXd weights(Eigen::Index point) const;
  /// Returns the vector from the element's begin to a point. @param tangents  nodes x 3
  [[nodiscard]] Eigen::Vector3d from_begin(Eigen::Index point,
                                           const Eigen::MatrixX3d& tangents) const {
    return tangents.middleRows(first_, own_.rows()).transpose() * own_.col(point);
  }
  /// Returns positions, 3 x points. @param tangents  nodes x 3
  [[nodiscard]] Eigen::Matrix3Xd positions(const Eigen::MatrixX3d& tangents) const {
    return to_points(tangents).transpose();
  }
  /// Returns W^T A with the weights W, nodes x points. @param by_node  A, nodes x columns
  [[nodiscard]] Eigen::MatrixXd to_points(const Eigen::MatrixXd& by_node) const;
  /// Computes W B with the weights W, nodes x points. @param by_point  B, points x columns
  /// @param[out] by_node  nodes x columns
  void to_nodes(const Eigen::MatrixXd& by_point, Eigen::Ref<Eigen::MatrixXd> by_node) const;

 private:
  Eigen::VectorXd begin_;
  Eigen::Index first_ = 0;
  Eigen::MatrixXd own_;
};

/// Computes arc lengths and weights of a span's quadrature: the table's rule on each element.
void tabulate_nodes(const std::vector<Element>& elements, const LegendreTable& table,
                    Eigen::VectorXd& nodes, Eigen::VectorXd& weights);

/// Weights that give positions of a span's points, relative to the anchor, as sums over the
/// tangents at its nodes.
class PositionOperator {
 public:
  PositionOperator() = default;
  PositionOperator(const Span& span, std::vector<Element> elements, const LegendreTable& table);

  [[nodiscard]] const std::vector<Element>& elements() const { return elements_; }
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return nodes_; }
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  /// Returns one sign per element, for the interval from the anchor to an arc length at which an
  /// element ends: 1 for elements between the anchor and a later s, -1 for elements between an
  /// earlier s and the anchor, 0 for others.
  [[nodiscard]] std::vector<double> signs(double s) const;

  /// Returns the weights of the point where an element begins; for the number of elements, of the
  /// span's end.
  [[nodiscard]] Eigen::VectorXd begin(Eigen::Index element) const;
  /// Returns the weights of points of an element. @param shares  positions of the points, divided
  /// by the element's length
  [[nodiscard]] PointOperator points(Eigen::Index element, const Eigen::VectorXd& shares) const;
  /// Returns the weights of an element's begin, of its nodes and of its end.
  [[nodiscard]] PointOperator along(Eigen::Index element) const;
  /// Returns the weights of the point at arc length s.
  [[nodiscard]] Eigen::VectorXd at(double s) const;

  /// Weights of a point of an element, and of its derivatives by the arc length.
  struct Point {
    Eigen::VectorXd position, tangent, curvature;
  };
  /// Returns the weights of a point of an element. @param s  arc length in the span; it may lie
  /// slightly outside the element
  [[nodiscard]] Point at(Eigen::Index element, double s) const;

 private:
  [[nodiscard]] Eigen::MatrixXd functional_weights(const Eigen::MatrixXd& of_terms) const;

  std::vector<Element> elements_;
  const LegendreTable* table_ = nullptr;
  double anchor_ = 0;
  Eigen::VectorXd nodes_, weights_;
  Eigen::VectorXd to_anchor_;
};

/// PositionOperator::along() for all elements of a span, one after another.
class SpanPointOperator {
 public:
  explicit SpanPointOperator(const PositionOperator& reach);

  [[nodiscard]] Eigen::Index points() const { return weights_.size(); }
  /// Number of points of one element.
  [[nodiscard]] Eigen::Index element_points() const { return elements_.front().points(); }
  /// Returns the index of the first point of an element. If `element` is the number of elements,
  /// returns the index of the point at the end of the span.
  [[nodiscard]] Eigen::Index begin(Eigen::Index element) const {
    return std::min(element * element_points(), points() - 1);
  }
  /// Weights of the span's quadrature at the points; 0 at begins and ends of elements.
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  /// Returns weights(), each multiplied by a quantity per length that is constant on each element.
  [[nodiscard]] Eigen::VectorXd weights_with_density(const std::vector<double>& per_length) const;
  /// Returns W^T A with the points' position weights W. @param by_node  A, nodes x columns
  [[nodiscard]] Eigen::MatrixXd to_points(const Eigen::MatrixXd& by_node) const;
  /// Returns W B with the points' position weights W. @param by_point  B, points x columns
  [[nodiscard]] Eigen::MatrixXd to_nodes(const Eigen::MatrixXd& by_point) const;

 private:
  std::vector<PointOperator> elements_;
  Eigen::VectorXd weights_;
  Eigen::Index nodes_ = 0;
};

}  // namespace dlo::energy_model
