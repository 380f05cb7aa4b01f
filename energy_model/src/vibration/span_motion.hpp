#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "strain/span_energy.hpp"

namespace dlo::energy_model {

/// A mass at one point of a span.
struct SpanMass {
  double s = 0;
  double mass = 0;
};

/// How a span's points move with its unknowns, to first order, about one shape. Own units.
class SpanMotion {
 public:
  /// About the point of the model's last value().
  /// @param model  in space
  /// @param axes   rows: those that movements are told along, in the span's frame
  SpanMotion(SpanEnergy& model, const Eigen::Matrix3d& axes);
  /// @param table     on whose nodes in each piece the tangents are
  /// @param anchor    arc length of what does not move, a piece's end
  /// @param tangents  their derivatives by the unknowns, an axis each, nodes x unknowns
  SpanMotion(std::vector<Piece> pieces, const LegendreTable& table, double anchor,
             std::array<Eigen::MatrixXd, 3> tangents);

  /// Derivatives of the point at an arc length by the unknowns, 3 x unknowns.
  [[nodiscard]] Eigen::MatrixXd at(double s) const;

  /// Mass matrices of the movement along each axis, so that their sum says the kinetic energy:
  /// half of v^T M v with the unknowns' velocities v.
  /// @param per_length  of the piece with this index
  [[nodiscard]] std::array<Eigen::MatrixXd, 3> masses(
      const std::function<double(Eigen::Index)>& per_length,
      const std::vector<SpanMass>& points) const;

 private:
  [[nodiscard]] Eigen::MatrixXd from_start(double s) const;

  std::vector<Piece> pieces_;
  const LegendreTable* table_;
  Eigen::Index unknowns_;
  std::array<Eigen::MatrixXd, 3> tangents_;  // by axis, nodes x unknowns
  std::vector<Eigen::MatrixXd> begins_;      // of the pieces' begins from the start, 3 x unknowns
  Eigen::MatrixXd anchor_;                   // the same of what a grip holds
};

}  // namespace dlo::energy_model
