#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/legendre.hpp"

namespace dlo::energy_model {

/// An angle by its start and the coefficients of its derivative, piece by piece.
struct FittedAngle {
  double start = 0;
  Eigen::VectorXd coefficients;
};

/// The angle nearest to values at the nodes of all pieces, by least squares on each piece.
/// @param turns  rotation, by the coefficient of p_0 = 1, of the end of each piece (Piece::angle())
/// @param start  of the angle, if it is known
[[nodiscard]] FittedAngle fit_angle(const LegendreTable& table, const std::vector<double>& turns,
                                    const Eigen::VectorXd& angles, std::optional<double> start);

}  // namespace dlo::energy_model
