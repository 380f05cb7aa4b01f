#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "../helpers.hpp"

namespace dlo::test {

/// Damping and stress-free curvature of a RigidPolygon, and the floor below it.
struct PolygonSurroundings {
  double material_damping = 0;
  double natural_curvature = 0;
  double floor = -std::numeric_limits<double>::infinity();  ///< its y
};

/// A cantilever (EI = l = rho A = 1) under its weight along -y as a polygon of rigid segments with
/// point masses and springs at its joints, released at rest from straight along +x: Stoermer's and
/// Verlet's method with the segments' lengths as constraints (SHAKE). It shares no code with the
/// energy model. Its error is of second order in the length of a segment: the clamp holds the
/// middle of the first one, and the last point has half a mass. A time step is a quarter of the
/// squared length of a segment, or less if the damping of the joints is stiff. A floor is a spring
/// and a critical dashpot under each point, which never pull.
class RigidPolygon {
 public:
  RigidPolygon(int free_points, double gamma, const PolygonSurroundings& around = {})
      : count_(free_points),
        segment_(1 / (free_points + 0.5)),
        step_(0.25 * segment_ * segment_),
        gamma_(gamma),
        around_(around),
        points_(Eigen::Matrix2Xd::Zero(2, free_points + 2)),
        inverse_mass_(Eigen::VectorXd::Constant(free_points + 2, 1 / segment_)) {
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      points_(0, i) = (static_cast<double>(i) - 0.5) * segment_;
    }
    // For the fastest vibration, omega = 4 / segment^2, tau omega^2 dt is at most 1.
    if (around_.material_damping > 0) {
      step_ = std::min(step_, std::pow(segment_, 4) / (16 * around_.material_damping));
    }
    inverse_mass_.head(2).setZero();
    inverse_mass_[free_points + 1] *= 2;
  }

  /// Returns the tip at increasing times.
  [[nodiscard]] Eigen::Matrix2Xd tips(const std::vector<double>& times) {
    Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(times.size()));
    const std::vector<Eigen::Matrix2Xd> shapes = shapes_at(times);
    for (std::size_t k = 0; k < times.size(); ++k) {
      result.col(static_cast<Eigen::Index>(k)) = shapes[k].rightCols(1);
    }
    return result;
  }

  /// Returns the arc length of a point from the clamp.
  [[nodiscard]] double arc_length(Eigen::Index point) const {
    return (static_cast<double>(point) - 0.5) * segment_;
  }

  /// Returns the points, the first of which is inside the clamp, at increasing times.
  [[nodiscard]] std::vector<Eigen::Matrix2Xd> shapes_at(const std::vector<double>& times) {
    std::vector<Eigen::Matrix2Xd> result;
    double last = 0;
    Eigen::Matrix2Xd velocity = Eigen::Matrix2Xd::Zero(2, points_.cols());
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double count = std::ceil((times[k] - last) / step_);
      const double dt = (times[k] - last) / count;
      for (int i = 0; i < static_cast<int>(count); ++i) advance(dt, velocity);
      result.push_back(points_);
      last = times[k];
    }
    return result;
  }

 private:
  void advance(double dt, Eigen::Matrix2Xd& velocity) {
    velocity += dt / 2 * accelerations(velocity);
    const Eigen::Matrix2Xd before = points_;
    points_ += dt * velocity;
    satisfy_length_constraints(before);
    velocity = (points_ - before) / dt;
    velocity += dt / 2 * accelerations(velocity);
    satisfy_velocity_constraints(velocity);
  }

  [[nodiscard]] Eigen::Matrix2Xd accelerations(const Eigen::Matrix2Xd& velocity) const {
    Eigen::Matrix2Xd forces = Eigen::Matrix2Xd::Zero(2, points_.cols());
    for (Eigen::Index i = 1; i + 1 < points_.cols(); ++i) {
      const Eigen::Vector2d a = points_.col(i) - points_.col(i - 1);
      const Eigen::Vector2d b = points_.col(i + 1) - points_.col(i);
      const double angle = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      const double rate = turning(b, velocity.col(i + 1) - velocity.col(i)) -
                          turning(a, velocity.col(i) - velocity.col(i - 1));
      const double moment =
          (angle + around_.material_damping * rate) / segment_ - around_.natural_curvature;
      const Eigen::Vector2d on_a = moment / a.squaredNorm() * Eigen::Vector2d(-a.y(), a.x());
      const Eigen::Vector2d on_b = moment / b.squaredNorm() * Eigen::Vector2d(-b.y(), b.x());
      // The moment of the joint rotates the segment before it forwards and the one after it
      // backwards.
      forces.col(i) += on_a + on_b;
      forces.col(i - 1) -= on_a;
      forces.col(i + 1) -= on_b;
    }
    constexpr double stiffness = 1e7;  // per length
    for (Eigen::Index i = 2; i < points_.cols(); ++i) {
      const double depth = around_.floor - points_(1, i);
      if (!(depth > 0)) continue;
      forces(1, i) += std::max(0.0, stiffness * depth - 2 * std::sqrt(stiffness) * velocity(1, i)) /
                      inverse_mass_[i];
    }
    Eigen::Matrix2Xd result = forces * inverse_mass_.asDiagonal();
    result.row(1).rightCols(count_).array() -= gamma_;
    return result;
  }

  /// Returns the rate of rotation of a segment.
  [[nodiscard]] static double turning(const Eigen::Vector2d& along, const Eigen::Vector2d& rate) {
    return (along.x() * rate.y() - along.y() * rate.x()) / along.squaredNorm();
  }

  /// Solves the tridiagonal equations for the corrections of points along the segments of `along`.
  void correct(Eigen::Matrix2Xd& moved, const Eigen::Matrix2Xd& along, const Eigen::Matrix2Xd& by,
               const Eigen::VectorXd& misses) const {
    const Eigen::Index n = count_;
    Eigen::VectorXd diagonal(n), upper(n), lower(n), right = misses;
    for (Eigen::Index i = 0; i < n; ++i) {
      diagonal[i] = along.col(i).dot(by.col(i)) * (inverse_mass_[i + 1] + inverse_mass_[i + 2]);
      if (i > 0) lower[i] = -along.col(i).dot(by.col(i - 1)) * inverse_mass_[i + 1];
      if (i + 1 < n) upper[i] = -along.col(i).dot(by.col(i + 1)) * inverse_mass_[i + 2];
    }
    for (Eigen::Index i = 1; i < n; ++i) {
      const double factor = lower[i] / diagonal[i - 1];
      diagonal[i] -= factor * upper[i - 1];
      right[i] -= factor * right[i - 1];
    }
    for (Eigen::Index i = n - 1; i >= 0; --i) {
      if (i + 1 < n) right[i] -= upper[i] * right[i + 1];
      right[i] /= diagonal[i];
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      moved.col(i + 1) += inverse_mass_[i + 1] * right[i] * by.col(i);
      moved.col(i + 2) -= inverse_mass_[i + 2] * right[i] * by.col(i);
    }
  }

  [[nodiscard]] Eigen::Matrix2Xd segments(const Eigen::Matrix2Xd& points) const {
    return points.rightCols(count_) - points.middleCols(1, count_);
  }

  void satisfy_length_constraints(const Eigen::Matrix2Xd& before) {
    const Eigen::Matrix2Xd old = segments(before);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Matrix2Xd now = segments(points_);
      const Eigen::VectorXd misses =
          (now.colwise().squaredNorm().array() - segment_ * segment_).matrix().transpose() / 2;
      if (misses.cwiseAbs().maxCoeff() < 1e-14 * segment_) return;
      correct(points_, now, old, misses);
    }
  }

  void satisfy_velocity_constraints(Eigen::Matrix2Xd& velocity) const {
    const Eigen::Matrix2Xd now = segments(points_);
    correct(velocity, now, now, now.cwiseProduct(segments(velocity)).colwise().sum().transpose());
  }

  Eigen::Index count_;
  double segment_, step_, gamma_;
  PolygonSurroundings around_;
  Eigen::Matrix2Xd points_;
  Eigen::VectorXd inverse_mass_;
};

/// Returns step, 2 step, ... up to count steps.
inline std::vector<double> equal_times(int count, double step) {
  std::vector<double> times;
  for (int i = 1; i <= count; ++i) times.push_back(step * i);
  return times;
}

/// Returns the tip at increasing times, extrapolated to infinitely many points from a polygon and
/// one of twice as many.
inline Eigen::Matrix2Xd limit_of_tips(int free_points, double gamma,
                                      const PolygonSurroundings& around,
                                      const std::vector<double>& times) {
  const Eigen::Matrix2Xd coarse = RigidPolygon(free_points, gamma, around).tips(times);
  const Eigen::Matrix2Xd fine = RigidPolygon(2 * free_points, gamma, around).tips(times);
  const double ratio = std::pow((2 * free_points + 0.5) / (free_points + 0.5), 2);
  return fine + (fine - coarse) / (ratio - 1);
}

}  // namespace dlo::test
