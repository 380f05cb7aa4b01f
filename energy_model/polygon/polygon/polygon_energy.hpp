#pragma once

#include <Eigen/Core>
#include <functional>

#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {

/// Function that receives a 3 x 3 block of a Hessian that belongs to the points `row` and `column`.
/// Blocks on both sides of the diagonal are passed. Some are passed more than once and have to be
/// added up.
using AddBlock =
    std::function<void(Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block)>;

/// Adds the Hessian H by the differences d_p = P_(p+1) - P_p and d_q to the blocks of points.
void add_difference_block(Eigen::Index p, Eigen::Index q, const Eigen::Matrix3d& H,
                          const AddBlock& add);

/// Terms of the Hessian to compute.
enum class HessianTerms {
  all,
  /// Without the terms that make the Hessian negative: compressed segments, moments of joints and
  /// forces of round obstacles change their direction as the points move sideways. Far from
  /// equilibrium these terms are the largest and the least informative (as in projected Newton
  /// methods for cloth: Teran et al., 2005).
  stiffening,
};

/// Computes the Hessian of polygon_energy(), without the part of twist_columns().
void polygon_hessian(const PolygonProblem& problem,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& points, HessianTerms which,
                     const AddBlock& add);

}  // namespace dlo::energy_model
