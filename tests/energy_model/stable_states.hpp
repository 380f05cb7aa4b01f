#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "../helpers.hpp"
#include "base/minimise.hpp"
#include "dlo/energy_model/energy.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::test {

/// Stable states of planar rods of unit length and stiffness, found by brute force: polygons are
/// relaxed from many random shapes, and each is the initial guess of one refinement. No initial
/// guess, ranking or escape of the energy model's search is used.
class StableStates {
 public:
  enum class Held { clamp, clamp_and_pin, two_clamps };

  explicit StableStates(unsigned seed) : random_(seed) {}

  [[nodiscard]] energy_model::Problem random_problem(Held held) {
    energy_model::Problem problem;
    problem.length = 1;
    problem.bending_stiffness = 1;
    const double gamma = std::pow(10, -1 + 3.477 * unit(0, 1));  // 0.1 to 300
    problem.weight_per_length = {0, -gamma, 0};
    const double begin = unit(-pi, pi);
    problem.grips = {{0, {0, 0, 0}, direction(begin)}};
    if (held == Held::clamp) return problem;
    const double apart = unit(0.3, 0.95);
    const Eigen::Vector3d end = apart * direction(unit(-pi, pi));
    problem.grips.push_back({1, end, {}});
    if (held == Held::two_clamps) problem.grips[1].direction = direction(unit(-pi, pi));
    return problem;
  }

  /// Returns converged shapes that are near polygons from which they were found, without
  /// duplicates.
  [[nodiscard]] std::vector<energy_model::Equilibrium> find(const energy_model::Problem& problem,
                                                            int starts) {
    std::vector<Eigen::VectorXd> polygons;
    std::vector<energy_model::Equilibrium> found;
    for (int i = 0; i < starts; ++i) {
      const std::optional<Eigen::VectorXd> angles = relaxed(problem, random_angles(problem));
      if (!angles || is_known(polygons, *angles)) continue;
      polygons.push_back(*angles);
      const energy_model::Equilibrium start = shape_of(*angles);
      energy_model::Equilibrium state = solve_energy(problem, {.start = &start});
      if (!succeeded(state.status) || distance(state, start) > near) continue;
      const auto same = [&](const auto& other) { return distance(state, other) < 1e-5; };
      if (std::none_of(found.begin(), found.end(), same)) found.push_back(std::move(state));
    }
    return found;
  }

  /// Returns the largest distance of two shapes' points at equal arc length.
  [[nodiscard]] static double distance(const energy_model::Equilibrium& a,
                                       const energy_model::Equilibrium& b) {
    const std::vector<double> at = energy_model::equal_arc_lengths(1, 33);
    return (a.sample(at).points - b.sample(at).points).colwise().norm().maxCoeff();
  }

 private:
  static constexpr double pi = std::numbers::pi;
  static constexpr Eigen::Index segments = 60;
  static constexpr double near = 0.1;  // largest distance of a shape from its polygon, in l

  [[nodiscard]] double unit(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  [[nodiscard]] static Eigen::Vector3d direction(double angle) {
    return {std::cos(angle), std::sin(angle), 0};
  }
  [[nodiscard]] static double angle_of(const Eigen::Vector3d& v) {
    return std::atan2(v.y(), v.x());
  }

  /// Returns angles of the segments: linear from end to end, with up to one additional turn, plus
  /// waves.
  [[nodiscard]] Eigen::VectorXd random_angles(const energy_model::Problem& problem) {
    const double begin = angle_of(*problem.grips[0].direction);
    double end = begin + unit(-2 * pi, 2 * pi);
    if (problem.grips.size() > 1 && problem.grips[1].direction) {
      end = angle_of(*problem.grips[1].direction);
      end += 2 * pi * (std::round((begin - end) / (2 * pi)) + std::floor(unit(-1, 2)));
    }
    Eigen::VectorXd angles = Eigen::VectorXd::LinSpaced(segments, begin, end);
    for (int wave = 1; wave <= 5; ++wave) {
      const double amplitude = unit(-3, 3) / wave;
      for (Eigen::Index i = 0; i < segments; ++i) {
        const double s = (static_cast<double>(i) + 0.5) / segments;
        angles[i] += amplitude * std::sin(wave * pi * s);
      }
    }
    return angles;
  }

  /// Returns a local minimum of bending and gravity, with a gripped end held by a spring of
  /// increasing stiffness. Returns std::nullopt if the minimisation fails.
  [[nodiscard]] std::optional<Eigen::VectorXd> relaxed(const energy_model::Problem& problem,
                                                       Eigen::VectorXd angles) const {
    // The angle at the last clamp is the one nearest to the last angle of the initial guess, modulo
    // full turns.
    std::optional<double> last;
    if (problem.grips.size() > 1 && problem.grips[1].direction) {
      const double clamp = angle_of(*problem.grips[1].direction);
      last = clamp + 2 * pi * std::round((angles[segments - 1] - clamp) / (2 * pi));
    }
    for (const double spring : {1e2, 1e3, 1e4, 1e6}) {
      const auto objective = [&](const auto& x, auto gradient) {
        return energy(problem, last, spring, x, gradient);
      };
      const auto result = energy_model::minimise_lbfgs(
          objective, angles,
          {.gradient_tolerance = 1e-6, .max_evaluations = 600, .stored_steps = 20});
      if (!angles.allFinite() || result.status == energy_model::SolveStatus::failed) {
        return std::nullopt;
      }
      if (problem.grips.size() == 1) break;
    }
    return angles;
  }

  [[nodiscard]] static double energy(const energy_model::Problem& problem,
                                     const std::optional<double>& last, double spring,
                                     const Eigen::Ref<const Eigen::VectorXd>& x,
                                     Eigen::Ref<Eigen::VectorXd> gradient) {
    constexpr double h = 1.0 / segments;
    const double first = angle_of(*problem.grips[0].direction);
    const double weight = -problem.weight_per_length.y();
    gradient.setZero();
    // Half a segment from a clamp to the first segment's middle.
    double value = (x[0] - first) * (x[0] - first) / h;
    gradient[0] += 2 * (x[0] - first) / h;
    for (Eigen::Index i = 0; i + 1 < segments; ++i) {
      const double turn = x[i + 1] - x[i];
      value += turn * turn / (2 * h);
      gradient[i] -= turn / h;
      gradient[i + 1] += turn / h;
    }
    if (last) {
      const double turn = *last - x[segments - 1];
      value += turn * turn / h;
      gradient[segments - 1] -= 2 * turn / h;
    }
    Eigen::Vector2d miss = Eigen::Vector2d::Zero();
    if (problem.grips.size() > 1) {
      miss = -problem.grips[1].position.head<2>();
      for (Eigen::Index i = 0; i < segments; ++i) {
        miss += h * Eigen::Vector2d(std::cos(x[i]), std::sin(x[i]));
      }
    } else {
      spring = 0;
    }
    value += spring * miss.squaredNorm() / 2;
    for (Eigen::Index i = 0; i < segments; ++i) {
      // A segment raises all points beyond its middle.
      const double lifts = h * weight * h * (static_cast<double>(segments - i) - 0.5);
      value += lifts * std::sin(x[i]);
      gradient[i] += lifts * std::cos(x[i]) +
                     spring * h * (miss.y() * std::cos(x[i]) - miss.x() * std::sin(x[i]));
    }
    return value;
  }

  [[nodiscard]] static bool is_known(const std::vector<Eigen::VectorXd>& known,
                                     const Eigen::VectorXd& angles) {
    return std::any_of(known.begin(), known.end(), [&](const Eigen::VectorXd& other) {
      return (other - angles).cwiseAbs().maxCoeff() < 0.01;
    });
  }

  /// Returns an initial guess: points and tangents, interpolated between the middles of the
  /// segments.
  [[nodiscard]] static energy_model::Equilibrium shape_of(const Eigen::VectorXd& angles) {
    energy_model::Equilibrium shape;
    shape.status = energy_model::SolveStatus::not_verified;
    shape.sample = [angles](std::span<const double> arc_lengths) {
      energy_model::Samples samples;
      const auto count = static_cast<Eigen::Index>(arc_lengths.size());
      samples.arc_length.assign(arc_lengths.begin(), arc_lengths.end());
      samples.points.resize(3, count);
      samples.tangents.resize(3, count);
      samples.curvature = Eigen::Matrix3Xd::Zero(3, count);
      for (Eigen::Index k = 0; k < count; ++k) {
        const double at = arc_lengths[static_cast<std::size_t>(k)] * segments;
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
        for (Eigen::Index i = 0; i < segments; ++i) {
          const double part = std::clamp(at - static_cast<double>(i), 0.0, 1.0);
          point += part / segments * direction(angles[i]);
        }
        const double middle = std::clamp(at - 0.5, 0.0, segments - 1.0);
        const auto before = std::min(static_cast<Eigen::Index>(middle), segments - 2);
        const double share = middle - static_cast<double>(before);
        samples.points.col(k) = point;
        samples.tangents.col(k) =
            direction((1 - share) * angles[before] + share * angles[before + 1]);
      }
      return samples;
    };
    return shape;
  }

  std::mt19937 random_;
};

}  // namespace dlo::test
