#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "../helpers.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::test {

/// Kinds of random_problem(): in the x-y plane, anywhere in space, in space and twisted, not
/// intrinsically straight (curved), straight with all kinds of grips (mixed), and with two bending
/// stiffnesses (strip).
enum class RandomSpace { plane, space, twisted, curved, mixed, strip };

inline const char* name_of(RandomSpace space) {
  if (space == RandomSpace::twisted) return "twisted";
  if (space == RandomSpace::curved) return "curved";
  if (space == RandomSpace::mixed) return "mixed";
  if (space == RandomSpace::strip) return "strip";
  return space == RandomSpace::plane ? "plane" : "space";
}

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every machine and with every library,
/// which the distributions of <random> do not promise.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }
  double uniform(double low = 0, double high = 1) {
    return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53;
  }
  /// Returns an integer in [0, count).
  int below(int count) { return static_cast<int>(uniform() * count); }
  bool chance(double probability) { return uniform() < probability; }

  Eigen::Vector3d direction(RandomSpace space) {
    const double angle = uniform(-std::numbers::pi, std::numbers::pi);
    const double z = space == RandomSpace::plane ? 0 : uniform(-1, 1);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::uint64_t state_;
};

/// A smooth curve of unit length, whose tangent rotates at a rate that is a constant plus three
/// waves, all with random coefficients. It consists of 1000 straight steps of equal length, so that
/// no two points are further apart than the curve between them.
class RandomCurve {
 public:
  RandomCurve(RandomNumbers& random, RandomSpace space) {
    const double bend = random.uniform(0.3, 8);  // curvature [1/l]
    constexpr int waves = 3;
    std::vector<Eigen::Vector3d> amplitudes;
    std::vector<double> phases;
    for (int k = 0; k <= waves; ++k) {
      Eigen::Vector3d axis = random.direction(RandomSpace::space);
      if (space == RandomSpace::plane) axis = {0, 0, axis.z()};
      amplitudes.emplace_back(bend * random.uniform() * axis);
      phases.push_back(random.uniform(0, 2 * std::numbers::pi));
    }
    tangents_.resize(3, steps);
    points_.setZero(3, steps + 1);
    Eigen::Vector3d t = random.direction(space);
    for (Eigen::Index i = 0; i < steps; ++i) {
      const double s = (static_cast<double>(i) + 0.5) / steps;
      Eigen::Vector3d rate = amplitudes[0];
      for (std::size_t k = 1; k < amplitudes.size(); ++k) {
        rate +=
            amplitudes[k] * std::sin(2 * std::numbers::pi * static_cast<double>(k) * s + phases[k]);
      }
      if (rate.norm() > 0) {
        t = Eigen::AngleAxisd(rate.norm() / steps, rate.normalized()) * t;
        t.normalize();
      }
      tangents_.col(i) = t;
      points_.col(i + 1) = points_.col(i) + t / static_cast<double>(steps);
    }
  }

  [[nodiscard]] Eigen::Vector3d point(double s) const { return points_.col(index(s)); }
  [[nodiscard]] Eigen::Vector3d tangent(double s) const {
    return tangents_.col(std::min(index(s), steps - 1));
  }

 private:
  static constexpr Eigen::Index steps = 1000;
  static Eigen::Index index(double s) { return static_cast<Eigen::Index>(std::lround(s * steps)); }

  Eigen::Matrix3Xd tangents_;
  Eigen::Matrix3Xd points_;
};

/// Returns a multiple of 1/1000 in [low, high], so that a scene file can contain it.
inline double random_arc_length(RandomNumbers& random, double low, double high) {
  return std::round(1000 * random.uniform(low, high)) / 1000;
}

/// Returns arc lengths of `count` grips, at least 0.05 l apart, the first and the last one often at
/// an end.
inline std::vector<double> random_grip_places(RandomNumbers& random, int count) {
  constexpr double least = 0.05;
  for (;;) {
    std::vector<double> places;
    places.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) places.push_back(random_arc_length(random, 0, 1));
    std::sort(places.begin(), places.end());
    if (random.chance(0.5)) places.front() = 0;
    if (random.chance(count == 1 ? 0.2 : 0.4)) places.back() = 1;
    bool apart = true;
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      apart = apart && places[i + 1] - places[i] >= least;
    }
    if (apart) return places;
  }
}

inline energy_model::Problem twisted_problem(std::uint64_t number);
inline energy_model::Problem curved_problem(std::uint64_t number);
inline energy_model::Problem mixed_problem(std::uint64_t number);
inline energy_model::Problem strip_problem(std::uint64_t number);

/// Limits of a random problem.
struct RandomLimits {
  int grips = 3;
  double gamma_exponent = 4;
};

/// Returns a rod of unit length and stiffness as described at random_problem().
inline energy_model::Problem random_held_rod(RandomNumbers& random, RandomSpace space,
                                             const RandomLimits& limits = {}) {
  energy_model::Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  const double gamma = std::pow(10, random.uniform(-2, limits.gamma_exponent));
  problem.weight_per_length = {0, -gamma, 0};
  const RandomCurve curve(random, space);
  const int kind = random.below(3);
  const bool turned = kind == 1;
  const double nearer = kind == 2 ? random.uniform(0.05, 1) : 0.999;
  const int grips = 1 + random.below(limits.grips);
  for (const double at : random_grip_places(random, grips)) {
    energy_model::Grip& grip = problem.grips.emplace_back();
    grip.at = at;
    grip.position = nearer * curve.point(at);
    if (random.chance(grips == 1 ? 0.85 : 0.55)) {
      grip.direction = turned ? random.direction(space) : curve.tangent(at);
    }
  }
  const int loads = random.below(4);
  for (int j = 0; j < loads; ++j) {
    const double size = random.uniform(0, 0.6) * (1 + gamma);
    const double at = random.chance(0.3) ? 1 : random_arc_length(random, 0, 1);
    problem.loads.push_back({at, size * random.direction(space)});
  }
  return problem;
}

/// Returns a random rod of unit length and stiffness. The same number always gives the same
/// problem.
///
/// A problem of the kind `plane` or `space` has a weight along -y with Gamma = w l^3 / (EI) between
/// 1e-2 and 1e4, 1 to 3 clamps and pins, and 0 to 3 loads of up to 0.6 (1 + Gamma) EI/l^2 each. The
/// grips are on a random curve, so that the rod reaches them; in a third of the problems they are
/// moved towards each other. Clamps have the directions of the curve; in a third of the problems
/// the directions are random.
///
/// A `twisted` problem is in space. It has two or three grips, all of them clamps that hold frames.
/// Each frame is rotated by up to 1.5 turns in either sense. GJ is 0.4 to 1.2 EI.
///
/// A `curved` problem has natural strains about each axis, or about d2 only in the plane: a
/// constant of up to 5/l, plus a part that is linear in the arc length, of up to 2/l at the ends. A
/// clamp holds the frame of its start. Half of the problems have an interval with another section,
/// and three quarters another clamp or pin. Gamma is between 0.1 and 316, and the weight has any
/// direction. Even numbers give problems in the x-y plane.
///
/// A `strip` is a curved problem, of which half are straight. Its EI about d2 is a tenth to ten
/// times that about d1. Its interval with another section, if any, is round in half of the
/// problems.
///
/// A `mixed` problem is straight and has 1 to 4 grips and Gamma up to 1e5. Even numbers give
/// problems in the x-y plane. In the others, half of the clamps hold frames, which are rotated by
/// up to 1.5 turns in either sense.
inline energy_model::Problem random_problem(std::uint64_t number, RandomSpace space) {
  if (space == RandomSpace::twisted) return twisted_problem(number);
  if (space == RandomSpace::curved) return curved_problem(number);
  if (space == RandomSpace::mixed) return mixed_problem(number);
  if (space == RandomSpace::strip) return strip_problem(number);
  RandomNumbers random(2 * number + (space == RandomSpace::space ? 1 : 0));
  return random_held_rod(random, space);
}

/// Returns a rod of unit length and stiffness between two clamps at its ends, with `pin` a pin
/// between them. Grips and clamps' directions are those of a random curve; in one of three problems
/// the directions are random ones, in one of three the grips are moved towards each other. Gamma is
/// between 0.1 and 1e4.
inline energy_model::Problem random_clamped_rod(std::uint64_t number, RandomSpace space, bool pin) {
  constexpr std::uint64_t of_their_own = 1U << 29U;
  RandomNumbers random(of_their_own + 4 * number + (space == RandomSpace::space ? 1 : 0) +
                       (pin ? 2 : 0));
  energy_model::Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.weight_per_length = {0, -std::pow(10, random.uniform(-1, 4)), 0};
  const RandomCurve curve(random, space);
  const int kind = random.below(3);
  const double nearer = kind == 2 ? random.uniform(0.05, 1) : 0.999;
  const double pinned_at = random_arc_length(random, 0.2, 0.8);
  const auto hold = [&](double at, bool clamped) {
    energy_model::Grip& grip = problem.grips.emplace_back();
    grip.at = at;
    grip.position = nearer * curve.point(at);
    if (clamped) grip.direction = kind == 1 ? random.direction(space) : curve.tangent(at);
  };
  hold(0, true);
  if (pin) hold(pinned_at, false);
  hold(1, true);
  return problem;
}

inline energy_model::Problem twisted_problem(std::uint64_t number) {
  constexpr double most_turns = 3;
  constexpr std::uint64_t of_their_own = 1U << 20U;
  RandomNumbers random(of_their_own + number);
  energy_model::Problem problem;
  for (std::uint64_t next = of_their_own + 64 * number; problem.grips.size() < 2; ++next) {
    problem = random_problem(next, RandomSpace::space);
  }
  problem.torsional_stiffness = random.uniform(0.4, 1.2);
  for (energy_model::Grip& grip : problem.grips) {
    if (!grip.direction) grip.direction = random.direction(RandomSpace::space);
    grip.frame = energy_model::FrameHold{};
    // Two clamps are rotated against each other by up to twice the roll, most_turns.
    grip.frame->roll = std::numbers::pi * random.uniform(-most_turns, most_turns);
  }
  return problem;
}

inline energy_model::Problem mixed_problem(std::uint64_t number) {
  constexpr std::uint64_t of_their_own = 1U << 28U;
  constexpr double most_turns = 3;
  RandomNumbers random(of_their_own + number);
  const bool planar = number % 2 == 0;
  energy_model::Problem problem = random_held_rod(
      random, planar ? RandomSpace::plane : RandomSpace::space, {.grips = 4, .gamma_exponent = 5});
  if (planar) return problem;
  problem.torsional_stiffness = random.uniform(0.4, 1.2);
  for (energy_model::Grip& grip : problem.grips) {
    if (!grip.direction || random.chance(0.5)) continue;
    grip.frame.emplace().roll = std::numbers::pi * random.uniform(-most_turns, most_turns);
  }
  return problem;
}

inline energy_model::Problem curved_problem(std::uint64_t number) {
  constexpr std::uint64_t of_their_own = 1U << 24U;
  RandomNumbers random(of_their_own + number);
  const bool planar = number % 2 == 0;
  const RandomSpace space = planar ? RandomSpace::plane : RandomSpace::space;
  const auto strain = [&](double most) {
    const double bend = random.uniform(-most, most);
    if (planar) return Eigen::Vector3d(0, bend, 0);
    return Eigen::Vector3d(random.uniform(-most, most), bend, random.uniform(-most, most));
  };
  energy_model::Problem problem;
  problem.length = 1;
  problem.bending_stiffness = 1;
  problem.torsional_stiffness = random.uniform(0.4, 1.2);
  const double gamma = std::pow(10, random.uniform(-1, 2.5));
  problem.weight_per_length = gamma * random.direction(space);
  problem.natural_strains = {strain(5), strain(2)};
  if (random.chance(0.5)) {
    const double begin = random_arc_length(random, 0.1, 0.5);
    problem.sections = {{begin, begin + 0.3, random.uniform(0.3, 4), random.uniform(0.3, 4),
                         random.uniform(0, 3) * problem.weight_per_length}};
  }
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const double roll = planar ? 0 : random.uniform(-1, 1);
  problem.grips = {{0, {0, 0, 0}, Eigen::Vector3d::UnitX(), energy_model::FrameHold{y, roll}}};
  const int kind = random.below(4);
  if (kind == 0) return problem;
  const double at = kind == 1 ? 0.7 : 1;
  const double height = planar ? 0 : random.uniform(-0.3, 0.3);
  energy_model::Grip& grip = problem.grips.emplace_back();
  grip.at = at;
  grip.position = {at * random.uniform(0.2, 0.75), at * random.uniform(-0.3, 0.3), height};
  if (kind > 1) grip.direction = random.direction(space);
  if (kind < 3) return problem;
  grip.frame.emplace().roll = planar ? 0 : random.uniform(-std::numbers::pi, std::numbers::pi);
  return problem;
}

inline energy_model::Problem strip_problem(std::uint64_t number) {
  constexpr std::uint64_t of_their_own = 1U << 26U;
  RandomNumbers random(of_their_own + number);
  energy_model::Problem problem = curved_problem(of_their_own + number);
  if (random.chance(0.5)) problem.natural_strains.clear();
  const auto ratio = [&] { return std::pow(10, random.uniform(-1, 1)); };
  problem.bending_stiffness_2 = ratio();
  for (energy_model::Section& section : problem.sections) {
    if (random.chance(0.5)) section.bending_stiffness_2 = section.bending_stiffness * ratio();
  }
  return problem;
}

}  // namespace dlo::test
