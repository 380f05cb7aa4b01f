#include "dlo/energy_model/turns.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/require.hpp"
#include "base/spin.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Returns the shortest rotation of a clamp's direction into another's; std::nullopt if they are
/// opposite and along the chord (shortest_rotation()).
std::optional<Eigen::Quaterniond> rotation_between(const Grip& from, const Grip& to,
                                                   double length) {
  return shortest_rotation(from.direction->normalized(), to.direction->normalized(),
                           (to.position - from.position) / length);
}

/// Returns the writhes in [-2, 2] of a curve that meets itself once, on either side of the passage.
std::pair<double, double> writhes_of_class(double modulo_two) {
  return {modulo_two, modulo_two - std::copysign(2, modulo_two)};
}

/// Returns the one of two numbers that is nearer to a third.
double nearer_of(double wanted, double one, double other) {
  return std::abs(one - wanted) <= std::abs(other - wanted) ? one : other;
}

/// Returns the clamp whose d1 determines that of clamps without d1.
const Grip& reference_clamp(const Problem& problem) {
  if (has_material_directors(problem)) return problem.grips[first_clamp(problem).value()];
  const Grip* first = nullptr;
  for (const Grip& grip : problem.grips) {
    if (grip.frame && (first == nullptr || grip.at < first->at)) first = &grip;
  }
  return *first;
}

/// Returns the d1 of reference_clamp() before its roll.
Eigen::Vector3d reference_d1(const Problem& problem, const Grip& clamp) {
  const Eigen::Vector3d direction = clamp.direction->normalized();
  if (clamp.frame && clamp.frame->d1) return part_across(*clamp.frame->d1, direction).normalized();
  if (!has_material_directors(problem)) return direction.unitOrthogonal();
  const double roll = clamp.frame ? clamp.frame->roll : 0;
  return Eigen::AngleAxisd(-roll, direction) * first_frame(problem).col(0);
}

}  // namespace

Eigen::Vector3d held_d1(const Problem& problem, const Grip& grip) {
  require(grip.direction && grip.frame, "held_d1", "arc length of a grip without a frame", grip.at,
          "the arc length of a clamp with a frame");
  if (grip.frame->d1)
    return part_across(*grip.frame->d1, grip.direction->normalized()).normalized();
  const Grip& first = reference_clamp(problem);
  Eigen::Vector3d d1 = reference_d1(problem, first);
  if (first.at == grip.at) return d1;
  const auto rotation = rotation_between(first, grip, problem.length);
  require(rotation.has_value(), "Problem",
          "arc length of a clamp whose frame lacks d1 and whose direction is opposite to that of "
          "the first clamp, in line with it",
          grip.at, "the arc length of a clamp with d1");
  return *rotation * d1;
}

std::optional<double> held_turns(const Problem& problem, const Grip& first, const Grip& last) {
  const auto rotation = rotation_between(first, last, problem.length);
  if (!rotation) return std::nullopt;
  const Eigen::Vector3d carried = *rotation * held_d1(problem, first);
  const Eigen::Vector3d d1 = held_d1(problem, last);
  const double angle =
      std::atan2(carried.cross(d1).dot(last.direction->normalized()), carried.dot(d1));
  return (wrap_to_pi(angle) + last.frame->roll - first.frame->roll) / (2 * pi);
}

HeldTurns prescribed_turns(const Problem& problem, const Grip& first, const Grip& last) {
  HeldTurns held{.roll = last.frame->roll - first.frame->roll, .turns = std::nullopt};
  if (problem.natural_strains.empty() || last.frame->d1)
    held.turns = held_turns(problem, first, last);
  return held;
}

double end_rotation(const HeldTurns& held, double frame_angle, double twist,
                    const std::optional<Writhe>& writhe) {
  const double angle = wrap_to_pi(frame_angle) + held.roll;
  if (!held.turns || !writhe) return angle;
  const auto to_turns_with = [&](double w) {
    return angle + 2 * pi * std::round(*held.turns - (twist + angle) / (2 * pi) - w);
  };
  if (writhe->value) return to_turns_with(*writhe->value);
  const auto [one, other] = writhes_of_class(writhe->modulo_two);
  return nearer_of(0, to_turns_with(one), to_turns_with(other));
}

double nearest_writhe(const Writhe& writhe, double wanted) {
  const auto [one, other] = writhes_of_class(writhe.modulo_two);
  return writhe.value.value_or(nearer_of(wanted, one, other));
}

std::optional<int> missing_turns(const HeldTurns& held, double twist,
                                 const std::optional<Writhe>& writhe) {
  if (!held.turns || !writhe) return 0;
  const double missing = *held.turns - twist / (2 * pi);
  const double in_class = std::remainder(missing - writhe->modulo_two, 2);
  if (std::abs(in_class) >= 0.5) return std::nullopt;
  return static_cast<int>(std::round(missing - nearest_writhe(*writhe, missing)));
}

}  // namespace dlo::energy_model
