#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/obstacle/body.hpp"
#include "frames/position_operator.hpp"

namespace dlo::energy_model {

/// Values of ContactRows at a shape.
struct ContactPlace {
  /// Values of the row of a smallest clearance.
  struct Touch {
    PositionOperator::Point point;  ///< weights of the point
    double at = 0;                  ///< arc length of the point
    obstacle::Gap gap;
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
    double rate = 0;  ///< second derivative of the clearance by s; 0 if no minimum was found
  };
  Eigen::VectorXd residual;  ///< residuals of all rows
  /// Derivatives of the rows by the tangents: a matrix for each axis, nodes x rows.
  std::array<Eigen::MatrixXd, 3> by_tangent;
  std::vector<Touch> touches;
  /// Clearances of points from bodies other than half-spaces, a list for each contact with one.
  std::vector<std::vector<obstacle::Gap>> gaps;

  /// Returns the products of the rows' derivatives with the vectors at the nodes, nodes x rows.
  [[nodiscard]] Eigen::MatrixXd along(const Eigen::MatrixX3d& vectors) const;
  /// Returns the gradient of a row by the tangents, nodes x 3.
  [[nodiscard]] Eigen::MatrixX3d by_node(Eigen::Index row) const;
  /// Adds the sum of multipliers times by_node() to `carried`.
  void add(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixX3d& carried) const;
};

/// Returns the moment about the anchor of forces that act on all that lies beyond each node.
/// @param carried  weight of the node times the force that the rod carries there, nodes x 3
[[nodiscard]] Eigen::Vector3d moment_about_anchor(const Eigen::MatrixX3d& tangents,
                                                  const Eigen::MatrixX3d& carried);

}  // namespace dlo::energy_model
