#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string_view>
#include <vector>

#include "dlo/energy_model/natural_frame.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// A part whose weight holds the line loads on it too: weight_per_length at its begin.
struct RodPart : Section {
  Eigen::Vector3d weight_slope = Eigen::Vector3d::Zero();  ///< by which it grows [N/m^2]
};

/// The rod from end to end as parts of one section each, cut where line loads begin and end, by
/// growing arc length.
[[nodiscard]] std::vector<RodPart> rod_parts(const Problem& problem);

/// Returns int ds / GJ over the parts between two arc lengths [rad/(N m)]; infinite where GJ is 0.
[[nodiscard]] double torsional_compliance(const std::vector<RodPart>& parts, double begin,
                                          double end);

/// Whether it is the same along all of the rod.
[[nodiscard]] bool acts_everywhere(const LineLoad& load, const Problem& problem);

/// Weight per length outside sections, with the line loads that act everywhere [N/m].
[[nodiscard]] Eigen::Vector3d weight_everywhere(const Problem& problem);

/// Two directions of the plane in which couples about this axis bend a rod.
[[nodiscard]] inline std::array<Eigen::Vector3d, 2> plane_across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d one = axis.unitOrthogonal();
  return {one, axis.normalized().cross(one)};
}

/// The smaller EI outside sections [N m^2]: what stiffnesses, and with the length forces, are
/// measured in, so that a strip's scales are those of the axis about which it yields.
[[nodiscard]] double bending_unit(const Problem& problem);

/// Neither drag nor a load that follows the rod.
[[nodiscard]] bool has_dead_loads(const Problem& problem);

/// How many clamps hold the rod's frame: two twist it.
[[nodiscard]] int clamps_with_frames(const Problem& problem);

/// @throws std::invalid_argument if the rod stretches, which solve_exact() alone knows
void require_inextensible(const Problem& problem, std::string_view function);

/// Whether it or one of its sections has a bending_stiffness_2.
[[nodiscard]] bool has_two_stiffnesses(const Problem& problem);

/// EI about d1 and d2 and GJ, over a unit [N m^2].
[[nodiscard]] Eigen::Vector3d principal_stiffness(const Section& section, double unit);

/// Strains of the stress-free shape at an arc length [1/m].
[[nodiscard]] Eigen::Vector3d natural_strain(const Problem& problem, double arc_length);

/// Frame (columns d1, d2, t) of a clamp that has this d1 before it is rolled.
[[nodiscard]] Eigen::Matrix3d held_frame(const Grip& clamp, const Eigen::Vector3d& d1);

}  // namespace dlo::energy_model
