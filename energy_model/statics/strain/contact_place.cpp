#include "strain/contact_place.hpp"

#include <Eigen/Geometry>

namespace dlo::energy_model {

Eigen::MatrixXd ContactPlace::along(const Eigen::MatrixX3d& vectors) const {
  Eigen::MatrixXd result = vectors.col(0).asDiagonal() * by_tangent[0];
  result += vectors.col(1).asDiagonal() * by_tangent[1];
  result += vectors.col(2).asDiagonal() * by_tangent[2];
  return result;
}

Eigen::MatrixX3d ContactPlace::by_node(Eigen::Index row) const {
  Eigen::MatrixX3d result(by_tangent[0].rows(), 3);
  result << by_tangent[0].col(row), by_tangent[1].col(row), by_tangent[2].col(row);
  return result;
}

void ContactPlace::add(const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                       Eigen::MatrixX3d& carried) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    carried.col(static_cast<Eigen::Index>(axis)).noalias() += by_tangent[axis] * multipliers;
  }
}

Eigen::Vector3d moment_about_anchor(const Eigen::MatrixX3d& tangents,
                                    const Eigen::MatrixX3d& carried) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (Eigen::Index q = 0; q < tangents.rows(); ++q) {
    moment += Eigen::Vector3d(tangents.row(q)).cross(Eigen::Vector3d(carried.row(q)));
  }
  return moment;
}

}  // namespace dlo::energy_model
