#include "dlo/force_model/tangent_stiffness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dlo/force_model/step_size.hpp"
#include "point_masses.hpp"
#include "require.hpp"
#include "stiffness_factor.hpp"
#include "stiffness_terms.hpp"
#include "twisted_spans.hpp"

namespace dlo::force_model {
namespace {

/// A second Newton step shorter than this fraction of the rod's length is due to rounding of
/// positions and forces.
constexpr double step_rounding_share = 1e-12;

/// Returns the index of each point among the free ones, -1 for rigidly held points.
std::vector<Eigen::Index> free_indices(const Rod& rod, Eigen::Index& count) {
  std::vector<Eigen::Index> indices(static_cast<std::size_t>(rod.points()), 0);
  for_each_grip_point(rod, GripHold::rigid, [&](const Grip& grip, Eigen::Index k) {
    indices[static_cast<std::size_t>(grip.first_point + k)] = -1;
  });
  count = 0;
  for (Eigen::Index& index : indices) {
    if (index == 0) index = count++;
  }
  return indices;
}

/// Collects minus the derivative of the total forces by the positions of the free points. The
/// matrix is symmetric: since the paper's law has no potential between unequal segments, its
/// antisymmetric part is dropped there. Each term depends on points x, exerts forces f on them, and
/// adds -df/dx.
class TangentStiffness {
 public:
  explicit TangentStiffness(const Rod& rod)
      : index_(free_indices(rod, count_)),
        across_plane_(rod.bending.natural_turns.size() > 0 ? rod.c_c / rod.rest_lengths.minCoeff()
                                                           : 0) {
    entries_.reserve(static_cast<std::size_t>(45 * count_));
  }

  [[nodiscard]] Eigen::Index free_points() const { return count_; }
  /// Returns the indices of the free points.
  [[nodiscard]] std::vector<Eigen::Index> point_indices() const {
    std::vector<Eigen::Index> points;
    for (std::size_t i = 0; i < index_.size(); ++i) {
      if (index_[i] >= 0) points.push_back(static_cast<Eigen::Index>(i));
    }
    return points;
  }

  /// @param block  -df_i/dx_j, with its transpose when i != j
  void add(Eigen::Index i, Eigen::Index j, const Eigen::Matrix3d& block) {
    const Eigen::Index row = index_[static_cast<std::size_t>(i)];
    const Eigen::Index column = index_[static_cast<std::size_t>(j)];
    if (row < 0 || column < 0) return;
    const Eigen::Index axes = across_plane_ > 0 ? 2 : 3;
    for (Eigen::Index k = 0; k < axes; ++k) {
      for (Eigen::Index m = 0; m < axes; ++m) {
        entries_.emplace_back(3 * row + k, 3 * column + m, block(k, m));
        if (i != j) entries_.emplace_back(3 * column + m, 3 * row + k, block(k, m));
      }
    }
  }

  /// Adds g g^T. @param g  vectors of all points
  void add_column(const Eigen::Matrix3Xd& g) {
    columns_.conservativeResize(3 * count_, columns_.cols() + 1);
    columns_.rightCols<1>() = gathered(g);
  }

  [[nodiscard]] BorderedMatrix matrix() const {
    BorderedMatrix result{Eigen::SparseMatrix<double>(3 * count_, 3 * count_), columns_};
    result.A.setFromTriplets(entries_.begin(), entries_.end());
    if (across_plane_ > 0) {
      for (Eigen::Index i = 2; i < 3 * count_; i += 3) result.A.insert(i, i) = across_plane_;
    }
    return result;
  }

  [[nodiscard]] Eigen::VectorXd gathered(const Eigen::Matrix3Xd& of_points) const {
    Eigen::VectorXd result(3 * count_);
    for (std::size_t i = 0; i < index_.size(); ++i) {
      if (index_[i] < 0) continue;
      result.segment<3>(3 * index_[i]) = of_points.col(static_cast<Eigen::Index>(i));
    }
    return result;
  }

  [[nodiscard]] Eigen::Matrix3Xd scattered(const Eigen::VectorXd& of_free_points) const {
    Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(index_.size()));
    for (std::size_t i = 0; i < index_.size(); ++i) {
      if (index_[i] < 0) continue;
      result.col(static_cast<Eigen::Index>(i)) = of_free_points.segment<3>(3 * index_[i]);
    }
    return result;
  }

 private:
  Eigen::Index count_ = 0;
  std::vector<Eigen::Index> index_;
  // Stiffness across the plane z = 0 for points that stay in it, else 0 [N/m].
  double across_plane_ = 0;
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::MatrixXd columns_;
};

/// Returns a direction of negative curvature of all points. Its largest displacement is 1, and the
/// sum of its displacements points towards +x, else +y, else +z.
Eigen::Matrix3Xd negative_curvature_direction(const Eigen::VectorXd& movement,
                                              const TangentStiffness& stiffness) {
  Eigen::Matrix3Xd direction = stiffness.scattered(movement);
  direction /= std::sqrt(direction.colwise().squaredNorm().maxCoeff());
  const Eigen::Vector3d whole = direction.rowwise().sum();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (std::abs(whole[axis]) < 1e-6) continue;
    if (whole[axis] < 0) direction = -direction;
    break;
  }
  return direction;
}

/// Adds the second derivative of E = theta^2 / (2 C) by the points: g g^T / C with the gradient g
/// of theta, and M times the second derivative of theta, which couples neighbours only
/// (TwistedSpan). The contribution of a joint to the latter is
///     aa: -(kb (t + u)^T + (t + u) kb^T) / (4 a^2),   t = (u + v) / (1 + u.v)
///     ab: (2 [u]x / (1 + u.v) - kb t^T) / (2 a b)
/// and bb as aa (Bergou et al., Discrete viscous threads, SIGGRAPH 2010). The skew parts of aa and
/// bb that these drop cancel with the neighbours'.
void add_twist(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
               TangentStiffness& stiffness) {
  const auto of_span = [&](const TwistedSpan& span, const Grip& /*first*/, const Grip& /*last*/) {
    Eigen::Matrix3Xd gradient(3, points.cols());
    twist_gradient(span, points, gradient);
    stiffness.add_column(gradient / std::sqrt(span.compliance));
    const double moment = twist_angle(span, points) / span.compliance;
    for (Eigen::Index i = span.first_segment + 1; i <= span.last_segment; ++i) {
      Eigen::Vector3d u = points.col(i) - points.col(i - 1);
      Eigen::Vector3d v = points.col(i + 1) - points.col(i);
      const double a = u.norm();
      const double b = v.norm();
      if (!(a > 0 && b > 0)) continue;
      u /= a;
      v /= b;
      const double opening = 1 + u.dot(v);
      if (!(opening > folded_joint_threshold)) continue;
      const Eigen::Vector3d kb = 2 / opening * u.cross(v);
      const Eigen::Vector3d t = (u + v) / opening;
      const Eigen::Matrix3d aa = -kb * (t + u).transpose() / (4 * a * a);
      const Eigen::Matrix3d bb = -kb * (t + v).transpose() / (4 * b * b);
      Eigen::Matrix3d across;  // [u]x
      across << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
      const Eigen::Matrix3d ab = (2 / opening * across - kb * t.transpose()) / (2 * a * b);
      add_joint(i, moment * (aa + aa.transpose()), moment * ab, moment * (bb + bb.transpose()),
                stiffness);
    }
  };
  for_each_twisted_span(rod, of_span);
}

void add_all(const Rod& rod, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
             TangentStiffness& stiffness) {
  add_segments(rod, points, std::numeric_limits<double>::infinity(), stiffness);
  add_joints(rod, points, stiffness);
  add_walls(rod, points, stiffness);
  add_springs(rod, points, stiffness);
  add_twist(rod, points, stiffness);
}

/// Returns the total forces on the free points.
Eigen::VectorXd free_forces(const Rod& rod, const Eigen::Matrix3Xd& points,
                            const TangentStiffness& stiffness) {
  Eigen::Matrix3Xd forces(3, points.cols());
  total_forces(rod, points, forces);
  return stiffness.gathered(forces);
}

void set_stable_without_error(EquilibriumCheck& result) {
  result.stable = true;
  result.proven = true;
  result.remaining_error = 0;
}

/// Data of Newton steps with a fixed K.
struct NewtonMatrix {
  const TangentStiffness& stiffness;
  const StiffnessFactor& factor;
  const SlowModes& slow;
  double rounding_of_force;  // rounding error of the forces [N]
};

/// Returns the minimum-norm Newton step without neutral modes. It is not finite if a force acts
/// along one of them.
Eigen::VectorXd newton_step(const Rod& rod, const Eigen::Matrix3Xd& at, const NewtonMatrix& K,
                            Eigen::Index neutral_modes) {
  const Eigen::MatrixXd neutral = K.slow.modes.leftCols(neutral_modes);
  const Eigen::VectorXd force = free_forces(rod, at, K.stiffness);
  const Eigen::VectorXd along = neutral.transpose() * force;
  if (along.norm() > K.rounding_of_force) return Eigen::VectorXd::Constant(force.size(), NAN);
  return K.factor.solve(force - neutral * along);
}

/// Computes the Newton step to the equilibrium, and a bound of the distance.
void bound_error(const Rod& rod, const Eigen::Matrix3Xd& points, const NewtonMatrix& K,
                 EquilibriumCheck& result) {
  const Eigen::VectorXd step = newton_step(rod, points, K, result.neutral_modes);
  if (!step.allFinite()) return;
  const double root_points = std::sqrt(static_cast<double>(points.cols()));
  const double error = step.norm() / root_points;
  result.remaining_error = error;
  result.step = K.stiffness.scattered(step);
  result.slowest_mode = K.slow.eigenvalues[result.neutral_modes];
  result.stable = true;
  result.rounding_error = std::numeric_limits<double>::epsilon() * rod.c_c *
                          points.cwiseAbs().maxCoeff() / rod.rest_lengths.minCoeff() /
                          result.slowest_mode;
  // A second step with the same K is evaluated. If it is at most a quarter of the first, the
  // equilibrium exists by Kantorovich's theorem, and its distance is bounded by the step.
  const Eigen::Matrix3Xd stepped = points + result.step;
  const double second = newton_step(rod, stepped, K, result.neutral_modes).norm() / root_points;
  const double share = second / error;
  if (!(second > std::max(step_rounding_share * rod.length(), result.rounding_error))) {
    result.proven = std::isfinite(second);
    result.remaining_error = error + second;
  } else if (share <= 0.25) {
    result.proven = true;
    result.remaining_error = error * (1 - std::sqrt(1 - 4 * share)) / (2 * share);
  }
}

}  // namespace

StiffnessMatrix tangent_stiffness(const Rod& rod,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  require_polygon("tangent_stiffness", points, rod.rest_lengths);
  require(rod.bending.natural_turns.size() == 0, "tangent_stiffness", "number of natural turns",
          static_cast<double>(rod.bending.natural_turns.size()), "0");
  TangentStiffness stiffness(rod);
  StiffnessMatrix result;
  result.points = stiffness.point_indices();
  add_all(rod, points, stiffness);
  const BorderedMatrix K = stiffness.matrix();
  result.entries = Eigen::MatrixXd(K.A);
  if (K.B.cols() > 0) result.entries += K.B * K.B.transpose();
  return result;
}

EquilibriumCheck check_equilibrium(const Rod& rod,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  require_polygon("check_equilibrium", points, rod.rest_lengths);
  EquilibriumCheck result;
  result.step.setZero(3, points.cols());
  TangentStiffness stiffness(rod);
  if (stiffness.free_points() == 0) {
    set_stable_without_error(result);
    return result;
  }
  add_all(rod, points, stiffness);
  const BorderedMatrix K = stiffness.matrix();
  StiffnessFactor factor(K);
  if (!factor.succeeded()) return result;
  // Rounding of K, which is banded, makes the sign of modes below this undefined.
  const double rounding = 64 * std::numeric_limits<double>::epsilon() * K.eigenvalue_bound();
  SlowModes slow;
  const bool positive = factor.is_positive();
  if (positive) slow = slow_modes(K, factor);
  if (!(slow.eigenvalues[0] > rounding)) {
    // A rod that rotates freely about its grips has zero modes, which are excluded.
    Eigen::Matrix3Xd descent;
    const Eigen::VectorXd movement = positive ? Eigen::VectorXd() : factor.negative_curvature(K);
    if (movement.size() > 0) descent = negative_curvature_direction(movement, stiffness);
    factor.compute(K.shifted(rounding));
    if (!factor.is_positive()) {
      result.negative_curvature_direction = std::move(descent);
      return result;
    }
    slow = slow_modes(K, factor);
    result.neutral_modes = static_cast<int>((slow.eigenvalues.array() <= rounding).count());
    // With so many points, rounding exceeds the rod's own first mode and the loads on each point.
    // It is then impossible to determine which movements have neither stiffness nor force.
    if (rounding > mode_bounds(rod, points).slowest && !rod.loads.isZero(0)) {
      result.neutral_modes = 0;
      return result;
    }
    if (result.neutral_modes == SlowModes::most) {
      // There may be further neutral modes. If no point has a force, none of them moves (the
      // paper's law has no stiffness where the rod is straight); else the error is unknown.
      const double largest = free_forces(rod, points, stiffness).cwiseAbs().maxCoeff();
      if (largest <= rounding * points.cwiseAbs().maxCoeff()) set_stable_without_error(result);
      return result;
    }
  }
  bound_error(rod, points, {stiffness, factor, slow, rounding * points.cwiseAbs().maxCoeff()},
              result);
  return result;
}

}  // namespace dlo::force_model
