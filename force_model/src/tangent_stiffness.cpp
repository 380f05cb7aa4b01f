#include "dlo/force_model/tangent_stiffness.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>

#include "require.hpp"

namespace dlo::force_model {
namespace {

constexpr Eigen::Index coupling = 2;  // points to either side that a point's force depends on
constexpr Eigen::Index stride = 2 * coupling + 1;

/// Index of each point among the free ones, -1 for rigidly held points.
std::vector<Eigen::Index> free_indices(const Rod& rod, Eigen::Index& count) {
  std::vector<Eigen::Index> indices(static_cast<std::size_t>(rod.points()), 0);
  for (const Grip& grip : rod.grips) {
    if (grip.hold == GripHold::spring) continue;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      indices[static_cast<std::size_t>(grip.first_point + k)] = -1;
    }
  }
  count = 0;
  for (Eigen::Index& index : indices) {
    if (index == 0) index = count++;
  }
  return indices;
}

using Factor =
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>;

/// With K = L D L^T and D_j < 0, the d with L^T d = e_j has d^T K d = D_j.
Eigen::Matrix3Xd falling_direction(const Factor& factor, const std::vector<Eigen::Index>& index) {
  const Eigen::VectorXd pivots = factor.vectorD();
  // The first of equals, as an upright rod has: it falls in the plane of x.
  const double lowest = pivots.minCoeff();
  Eigen::Index pivot = 0;
  while (!(pivots[pivot] <= 0.999 * lowest)) ++pivot;
  Eigen::VectorXd movement = factor.matrixU().solve(Eigen::VectorXd::Unit(pivots.size(), pivot));
  Eigen::Matrix3Xd direction = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(index.size()));
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] < 0) continue;
    direction.col(static_cast<Eigen::Index>(i)) = movement.segment<3>(3 * index[i]);
  }
  direction /= std::sqrt(direction.colwise().squaredNorm().maxCoeff());
  const Eigen::Vector3d whole = direction.rowwise().sum();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (std::abs(whole[axis]) < 1e-6) continue;
    if (whole[axis] < 0) direction = -direction;
    break;
  }
  return direction;
}

}  // namespace

EquilibriumCheck check_equilibrium(const Rod& rod,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  require_polygon("check_equilibrium", points, rod.rest_lengths);
  const Eigen::Index N = points.cols();
  Eigen::Index count = 0;
  const std::vector<Eigen::Index> index = free_indices(rod, count);
  EquilibriumCheck result;
  result.step.setZero(3, N);
  if (count == 0) {
    result.stable = true;
    result.remaining_error = 0;
    return result;
  }

  const double h = 1e-6 * rod.rest_lengths.minCoeff();
  Eigen::Matrix3Xd moved = points;
  Eigen::Matrix3Xd above(3, N);
  Eigen::Matrix3Xd below(3, N);
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(9 * stride * count));
  for (Eigen::Index first = 0; first < stride; ++first) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (Eigen::Index i = first; i < N; i += stride) moved(axis, i) = points(axis, i) + h;
      total_forces(rod, moved, above);
      for (Eigen::Index i = first; i < N; i += stride) moved(axis, i) = points(axis, i) - h;
      total_forces(rod, moved, below);
      for (Eigen::Index i = first; i < N; i += stride) {
        moved(axis, i) = points(axis, i);
        const Eigen::Index column = index[static_cast<std::size_t>(i)];
        if (column < 0) continue;
        const Eigen::Index end = std::min(N, i + coupling + 1);
        for (Eigen::Index j = std::max<Eigen::Index>(0, i - coupling); j < end; ++j) {
          const Eigen::Index row = index[static_cast<std::size_t>(j)];
          if (row < 0) continue;
          for (Eigen::Index k = 0; k < 3; ++k) {
            // Half to either side of the diagonal: the paper's law is not quite symmetric.
            const double value = (below(k, j) - above(k, j)) / (4 * h);
            entries.emplace_back(3 * row + k, 3 * column + axis, value);
            entries.emplace_back(3 * column + axis, 3 * row + k, value);
          }
        }
      }
    }
  }
  Eigen::SparseMatrix<double> stiffness(3 * count, 3 * count);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  total_forces(rod, points, above);
  Eigen::VectorXd force(3 * count);
  for (Eigen::Index i = 0; i < N; ++i) {
    const Eigen::Index row = index[static_cast<std::size_t>(i)];
    if (row >= 0) force.segment<3>(3 * row) = above.col(i);
  }
  const Factor factor(stiffness);
  if (factor.info() != Eigen::Success) return result;
  const Eigen::VectorXd step = factor.solve(force);
  for (Eigen::Index i = 0; i < N; ++i) {
    const Eigen::Index row = index[static_cast<std::size_t>(i)];
    if (row >= 0) result.step.col(i) = step.segment<3>(3 * row);
  }
  const double remaining = step.norm() / std::sqrt(static_cast<double>(N));
  result.stable = factor.vectorD().minCoeff() > 0 && std::isfinite(remaining);
  result.remaining_error = remaining;
  if (factor.vectorD().minCoeff() < 0) result.falling_direction = falling_direction(factor, index);
  return result;
}

}  // namespace dlo::force_model
