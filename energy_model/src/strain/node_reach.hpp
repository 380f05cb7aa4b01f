#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "base/legendre.hpp"
#include "problem/span.hpp"
#include "strain/piece.hpp"

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
  /// 3 x points. @param tangents  nodes x 3
  [[nodiscard]] Eigen::Matrix3Xd positions(const Eigen::MatrixX3d& tangents) const;
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

/// Positions of a span's points, from the anchor, as sums over the tangents at its nodes.
class NodeReach {
 public:
  NodeReach() = default;
  /// @param nodes, weights  of the span's quadrature
  NodeReach(const Span& span, std::vector<Piece> pieces, const LegendreTable& table,
            const Eigen::VectorXd& nodes, const Eigen::VectorXd& weights);

  /// Of where a piece begins; of the number of pieces: of the span's end.
  [[nodiscard]] Eigen::VectorXd begin(Eigen::Index piece) const;
  /// Of a piece's nodes, nodes x nodes of the piece.
  [[nodiscard]] Eigen::MatrixXd of_nodes(Eigen::Index piece) const;
  /// Of where a piece begins, as the only point.
  [[nodiscard]] PointsReach at_begin(Eigen::Index piece) const;
  /// Of where a piece begins, of its nodes, and of where it ends.
  [[nodiscard]] PointsReach along(Eigen::Index piece) const;

  /// A point of a piece and its derivatives by the arc length.
  struct Point {
    Eigen::VectorXd position, tangent, curvature;
  };
  /// @param s  of the span; somewhat beyond the piece too
  [[nodiscard]] Point at(Eigen::Index piece, double s) const;

 private:
  std::vector<Piece> pieces_;
  const LegendreTable* table_ = nullptr;
  Eigen::VectorXd weights_;
  Eigen::VectorXd to_anchor_;
};

}  // namespace dlo::energy_model
