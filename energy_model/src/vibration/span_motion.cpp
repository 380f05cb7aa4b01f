#include "vibration/span_motion.hpp"

#include <algorithm>
#include <utility>

#include "base/legendre.hpp"

namespace dlo::energy_model {
namespace {

std::vector<Piece> pieces_of(const SpanEnergy& model) {
  std::vector<Piece> result;
  for (Eigen::Index e = 0; e < model.pieces(); ++e) result.push_back(model.piece(e));
  return result;
}

std::array<Eigen::MatrixXd, 3> tangents_along(SpanEnergy& model, const Eigen::Matrix3d& axes) {
  const std::array<Eigen::MatrixXd, 3> own = model.tangent_jacobian();
  std::array<Eigen::MatrixXd, 3> result;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::RowVector3d axis = axes.row(static_cast<Eigen::Index>(i));
    // Twist of a round rod moves no point.
    result[i] = Eigen::MatrixXd::Zero(own[0].rows(), model.size());
    result[i].leftCols(own[0].cols()) = axis[0] * own[0] + axis[1] * own[1] + axis[2] * own[2];
  }
  return result;
}

}  // namespace

SpanMotion::SpanMotion(SpanEnergy& model, const Eigen::Matrix3d& axes)
    : SpanMotion(pieces_of(model), model.table(), model.span().anchor,
                 tangents_along(model, axes)) {}

SpanMotion::SpanMotion(std::vector<Piece> pieces, const LegendreTable& table, double anchor,
                       std::array<Eigen::MatrixXd, 3> tangents)
    : pieces_(std::move(pieces)),
      table_(&table),
      unknowns_(tangents[0].cols()),
      tangents_(std::move(tangents)) {
  const Eigen::Index Q = table_->nodes.size();
  Eigen::MatrixXd begin = Eigen::MatrixXd::Zero(3, unknowns_);
  Eigen::Index node = 0;
  for (const Piece& piece : pieces_) {
    begins_.push_back(begin);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      begin.row(static_cast<Eigen::Index>(axis)) +=
          piece.length * table_->weights.transpose() * tangents_[axis].middleRows(node, Q);
    }
    node += Q;
  }
  begins_.push_back(std::move(begin));
  anchor_ = from_start(anchor);
}

Eigen::MatrixXd SpanMotion::from_start(double s) const {
  std::size_t e = 0;
  while (e + 1 < pieces_.size() && s >= pieces_[e].end()) ++e;
  const Piece& piece = pieces_[e];
  const double xi = std::clamp((s - piece.begin) / piece.length, 0.0, 1.0);
  const LegendreTable& table = *table_;
  const Eigen::Index Q = table.nodes.size();
  Eigen::VectorXd values(Q);
  Eigen::VectorXd integrals(Q);
  legendre(xi, values, integrals);
  const Eigen::RowVectorXd along =
      piece.length * (table.values * integrals).cwiseProduct(table.weights).transpose();
  Eigen::MatrixXd result = begins_[e];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.row(static_cast<Eigen::Index>(axis)) +=
        along * tangents_[axis].middleRows(static_cast<Eigen::Index>(e) * Q, Q);
  }
  return result;
}

Eigen::MatrixXd SpanMotion::at(double s) const { return from_start(s) - anchor_; }

std::array<Eigen::MatrixXd, 3> SpanMotion::masses(
    const std::function<double(Eigen::Index)>& per_length,
    const std::vector<SpanMass>& points) const {
  std::array<Eigen::MatrixXd, 3> result;
  result.fill(Eigen::MatrixXd::Zero(unknowns_, unknowns_));
  const LegendreTable& table = *table_;
  const Eigen::Index Q = table.nodes.size();
  for (Eigen::Index e = 0; e < static_cast<Eigen::Index>(pieces_.size()); ++e) {
    const double length = pieces_[static_cast<std::size_t>(e)].length;
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
