#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>
#include <vector>

#include "base/legendre.hpp"
#include "frames/piece.hpp"
#include "problem/span.hpp"

namespace dlo::energy_model {

/// Positions of several points of one piece, as sums over the tangents at the span's nodes: those
/// of other pieces have the same weights in all of them.
class PointsReach {
 public:
  PointsReach() = default;
  /// @param begin  of where the piece begins
  /// @param first  of its nodes
  /// @param own    from there to the points, by its own nodes, nodes x points
  PointsReach(Eigen::VectorXd begin, Eigen::Index first, Eigen::MatrixXd own)
      : begin_(std::move(begin)), first_(first), own_(std::move(own)) {}

  [[nodiscard]] Eigen::Index points() const { return own_.cols(); }
  /// Weights of all nodes in one of them.
  [[nodiscard]] Eigen::VectorXd weights(Eigen::Index point) const;
  /// One of them, seen from where the piece begins. @param tangents  nodes x 3
  [[nodiscard]] Eigen::Vector3d from_begin(Eigen::Index point,
                                           const Eigen::MatrixX3d& tangents) const {
    return tangents.middleRows(first_, own_.rows()).transpose() * own_.col(point);
  }
  /// 3 x points. @param tangents  nodes x 3
  [[nodiscard]] Eigen::Matrix3Xd positions(const Eigen::MatrixX3d& tangents) const {
    return sums(tangents).transpose();
  }
  /// Reach^T A, points x columns of A. @param by_node  nodes x columns
  [[nodiscard]] Eigen::MatrixXd sums(const Eigen::MatrixXd& by_node) const;
  /// Reach B, nodes x columns of B. @param by_point  points x columns
  /// @param[out] by_node  nodes x columns
  void spread(const Eigen::MatrixXd& by_point, Eigen::Ref<Eigen::MatrixXd> by_node) const;

 private:
  Eigen::VectorXd begin_;
  Eigen::Index first_ = 0;
  Eigen::MatrixXd own_;
};

/// Arc lengths and weights of a span's quadrature, that of the table on each of its pieces.
void tabulate_nodes(const std::vector<Piece>& pieces, const LegendreTable& table,
                    Eigen::VectorXd& nodes, Eigen::VectorXd& weights);

/// Positions of a span's points, from the anchor, as sums over the tangents at its nodes.
class PositionOperator {
 public:
  PositionOperator() = default;
  PositionOperator(const Span& span, std::vector<Piece> pieces, const LegendreTable& table);

  [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }
  [[nodiscard]] const Eigen::VectorXd& nodes() const { return nodes_; }
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  /// Of the span up to an arc length at which a piece ends: 1 of a piece that it has beyond the
  /// anchor, -1 of one that it lacks before it, 0 of others.
  [[nodiscard]] std::vector<double> signs(double s) const;

  /// Of where a piece begins; of the number of pieces: of the span's end.
  [[nodiscard]] Eigen::VectorXd begin(Eigen::Index piece) const;
  /// Of points of a piece. @param shares  of its length, where they are
  [[nodiscard]] PointsReach points(Eigen::Index piece, const Eigen::VectorXd& shares) const;
  /// Of where a piece begins, as the only point.
  [[nodiscard]] PointsReach at_begin(Eigen::Index piece) const;
  /// Of where a piece begins, of its nodes, and of where it ends.
  [[nodiscard]] PointsReach along(Eigen::Index piece) const;
  /// Of a point of the span.
  [[nodiscard]] Eigen::VectorXd at(double s) const;

  /// A point of a piece and its derivatives by the arc length.
  struct Point {
    Eigen::VectorXd position, tangent, curvature;
  };
  /// @param s  of the span; somewhat beyond the piece too
  [[nodiscard]] Point at(Eigen::Index piece, double s) const;

 private:
  [[nodiscard]] Eigen::MatrixXd through(const Eigen::MatrixXd& of_terms) const;

  std::vector<Piece> pieces_;
  const LegendreTable* table_ = nullptr;
  double anchor_ = 0;
  Eigen::VectorXd nodes_, weights_;
  Eigen::VectorXd to_anchor_;
};

/// PositionOperator::along() of all pieces of a span, one after another.
class SpanReach {
 public:
  explicit SpanReach(const PositionOperator& reach);

  [[nodiscard]] Eigen::Index points() const { return weights_.size(); }
  /// Of each piece.
  [[nodiscard]] Eigen::Index piece_points() const { return pieces_.front().points(); }
  /// The first point of a piece; of the number of pieces: the span's end.
  [[nodiscard]] Eigen::Index begin(Eigen::Index piece) const {
    return std::min(piece * piece_points(), points() - 1);
  }
  /// Of the span's quadrature; 0 where pieces begin and end.
  [[nodiscard]] const Eigen::VectorXd& weights() const { return weights_; }
  /// The same times what each piece has per length.
  [[nodiscard]] Eigen::VectorXd weighed(const std::vector<double>& per_length) const;
  /// Reach^T A, points x columns of A. @param by_node  nodes x columns
  [[nodiscard]] Eigen::MatrixXd sums(const Eigen::MatrixXd& by_node) const;
  /// Reach B, nodes x columns of B. @param by_point  points x columns
  [[nodiscard]] Eigen::MatrixXd spread(const Eigen::MatrixXd& by_point) const;

 private:
  std::vector<PointsReach> pieces_;
  Eigen::VectorXd weights_;
  Eigen::Index nodes_ = 0;
};

}  // namespace dlo::energy_model
