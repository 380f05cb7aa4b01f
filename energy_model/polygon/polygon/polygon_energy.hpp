#pragma once

#include <Eigen/Core>
#include <functional>

#include "dlo/energy_model/polygon.hpp"

namespace dlo::energy_model {

/// Takes a 3 x 3 block of a Hessian that belongs to the points `row` and `column`; every block is
/// given, those below the diagonal too, some more than once to be added up.
using AddBlock =
    std::function<void(Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block)>;

/// Adds the Hessian H of a function of the differences d_p = P_(p+1) - P_p, d_q likewise.
void add_difference_block(Eigen::Index p, Eigen::Index q, const Eigen::Matrix3d& H,
                          const AddBlock& add);

/// Which terms of the Hessian are wanted.
enum class HessianTerms {
  all,
  /// Without what makes them negative: forces of compressed segments, couples of joints and pushes
  /// of round obstacles turn as the points move aside. Far from rest these terms are the largest
  /// and say least (as projected Newton methods for cloth have it: Teran et al., 2005).
  stiffening,
};

/// Hessian of polygon_energy, but for twist_columns.
void polygon_hessian(const PolygonProblem& problem,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& points, HessianTerms which,
                     const AddBlock& add);

}  // namespace dlo::energy_model
