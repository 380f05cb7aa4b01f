#include "vibration/span_motion.hpp"

#include <algorithm>
#include <utility>

#include "base/legendre.hpp"

namespace dlo::energy_model {

SpanMotion::SpanMotion(SpanEnergy& model, const Eigen::Matrix3d& axes)
    : model_(model), unknowns_(model.size()) {
  const std::array<Eigen::MatrixXd, 3> own = model.tangent_jacobian();
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::RowVector3d axis = axes.row(static_cast<Eigen::Index>(i));
    tangents_[i] = axis[0] * own[0] + axis[1] * own[1] + axis[2] * own[2];
  }
  // Twist of a round rod moves no point.
  for (Eigen::MatrixXd& axis : tangents_) {
    const Eigen::Index strains = axis.cols();
    axis.conservativeResize(Eigen::NoChange, unknowns_);
    axis.rightCols(unknowns_ - strains).setZero();
  }
  const Eigen::Index Q = model_.table().nodes.size();
  Eigen::MatrixXd begin = Eigen::MatrixXd::Zero(3, unknowns_);
  for (Eigen::Index e = 0; e < model_.pieces(); ++e) {
    begins_.push_back(begin);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      begin.row(static_cast<Eigen::Index>(axis)) += model_.piece(e).length *
                                                    model_.table().weights.transpose() *
                                                    tangents_[axis].middleRows(e * Q, Q);
    }
  }
  begins_.push_back(std::move(begin));
  anchor_ = from_start(model_.span().anchor);
}

Eigen::MatrixXd SpanMotion::from_start(double s) const {
  Eigen::Index e = 0;
  while (e + 1 < model_.pieces() && s >= model_.piece(e).end()) ++e;
  const Piece& piece = model_.piece(e);
  const double xi = std::clamp((s - piece.begin) / piece.length, 0.0, 1.0);
  const LegendreTable& table = model_.table();
  const Eigen::Index Q = table.nodes.size();
  Eigen::VectorXd values(Q);
  Eigen::VectorXd integrals(Q);
  legendre(xi, values, integrals);
  const Eigen::RowVectorXd along =
      piece.length * (table.values * integrals).cwiseProduct(table.weights).transpose();
  Eigen::MatrixXd result = begins_[static_cast<std::size_t>(e)];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.row(static_cast<Eigen::Index>(axis)) += along * tangents_[axis].middleRows(e * Q, Q);
  }
  return result;
}

Eigen::MatrixXd SpanMotion::at(double s) const { return from_start(s) - anchor_; }

std::array<Eigen::MatrixXd, 3> SpanMotion::masses(
    const std::function<double(Eigen::Index)>& per_length,
    const std::vector<SpanMass>& points) const {
  std::array<Eigen::MatrixXd, 3> result;
  result.fill(Eigen::MatrixXd::Zero(unknowns_, unknowns_));
  const LegendreTable& table = model_.table();
  const Eigen::Index Q = table.nodes.size();
  for (Eigen::Index e = 0; e < model_.pieces(); ++e) {
    const double length = model_.piece(e).length;
    const Eigen::VectorXd roots = (per_length(e) * length * table.weights).cwiseSqrt();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      Eigen::MatrixXd moved = length * table.integration * tangents_[axis].middleRows(e * Q, Q);
      moved.rowwise() += begins_[static_cast<std::size_t>(e)].row(row) - anchor_.row(row);
      moved = roots.asDiagonal() * moved;
      result[axis].noalias() += moved.transpose() * moved;
    }
  }
  for (const SpanMass& point : points) {
    const Eigen::MatrixXd moved = at(point.s);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto row = moved.row(static_cast<Eigen::Index>(axis));
      result[axis].noalias() += point.mass * row.transpose() * row;
    }
  }
  return result;
}

}  // namespace dlo::energy_model
