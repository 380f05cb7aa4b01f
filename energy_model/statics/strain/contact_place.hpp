#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "dlo/obstacle/body.hpp"
#include "frames/position_operator.hpp"

namespace dlo::energy_model {

/// What ContactRows have seen of the obstacles at a point.
struct ContactPlace {
  /// Of the row of a least clearance.
  struct Touch {
    PositionOperator::Point point;  ///< where it is
    double at = 0;                  ///< s there
    obstacle::Gap gap;
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
    double rate = 0;  ///< second derivative by s; 0 where there is no least one
  };
  Eigen::VectorXd residual;                   ///< of all rows
  std::array<Eigen::MatrixXd, 3> by_tangent;  ///< nodes x rows, an axis each
  std::vector<Touch> touches;
  std::vector<std::vector<obstacle::Gap>> gaps;  ///< of points beside what is not flat

  /// What the rows change by along these vectors at the nodes, nodes x rows.
  [[nodiscard]] Eigen::MatrixXd along(const Eigen::MatrixX3d& vectors) const;
  /// Gradient of a row by the tangents, nodes x 3.
  [[nodiscard]] Eigen::MatrixX3d by_node(Eigen::Index row) const;
  /// Adds the multipliers times by_node().
  void add(const Eigen::Ref<const Eigen::VectorXd>& multipliers, Eigen::MatrixX3d& carried) const;
  /// Moment about the anchor of what the multipliers stand for. @param tangents  there
  [[nodiscard]] Eigen::Vector3d moment(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                                       const Eigen::MatrixX3d& tangents) const;
};

}  // namespace dlo::energy_model
