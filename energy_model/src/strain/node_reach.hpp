#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/legendre.hpp"
#include "problem/span.hpp"
#include "strain/piece.hpp"

namespace dlo::energy_model {

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
