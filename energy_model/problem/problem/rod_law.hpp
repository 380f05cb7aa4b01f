#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "dlo/energy_model/equilibrium.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "dlo/energy_model/plane.hpp"
#include "dlo/energy_model/problem.hpp"

namespace dlo::energy_model {

/// Difference of arc lengths, divided by the rod length, below which they are treated as equal.
inline constexpr double same_arc_length_share = 1e-9;

/// A part of the rod whose weight includes the line loads on it; weight_per_length is that at its
/// begin.
struct RodPart : Section {
  /// Derivative of weight_per_length by arc length [N/m^2].
  Eigen::Vector3d weight_slope = Eigen::Vector3d::Zero();
};

/// Returns the rod from end to end as parts of one section each, cut where line loads begin and
/// end, by growing arc length.
[[nodiscard]] std::vector<RodPart> rod_parts(const Problem& problem);

/// Returns int ds / GJ over the parts between two arc lengths [rad/(N m)]; infinite where GJ is 0.
[[nodiscard]] double torsional_compliance(const std::vector<RodPart>& parts, double begin,
                                          double end);

/// Whether a line load is constant along the whole rod.
[[nodiscard]] bool is_uniform_over_rod(const LineLoad& load, const Problem& problem);

/// Returns the weight per length outside sections, including the line loads that are constant along
/// the whole rod [N/m].
[[nodiscard]] Eigen::Vector3d total_uniform_weight(const Problem& problem);

/// Returns two orthogonal unit directions of the plane in which couples about this axis bend a rod.
[[nodiscard]] inline std::array<Eigen::Vector3d, 2> plane_across(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d one = axis.unitOrthogonal();
  return {one, axis.normalized().cross(one)};
}

/// Returns the smaller EI outside sections [N m^2]. It is the unit of stiffness, and with the
/// length that of forces, so that the scales of a strip are those of its more flexible axis.
[[nodiscard]] double bending_unit(const Problem& problem);

/// Whether there is neither drag nor a load that follows the rod.
[[nodiscard]] bool has_dead_loads(const Problem& problem);

/// Returns the number of grips with Grip::frame; two of them twist the rod. The first clamp of a
/// rod with material directors holds them without Grip::frame too, but does not count then.
[[nodiscard]] int clamps_with_frames(const Problem& problem);

/// Throws if the rod stretches, which only solve_exact() supports.
/// @throws std::invalid_argument naming `function`
void require_inextensible(const Problem& problem, std::string_view function);

/// Whether the rod or one of its sections has a bending_stiffness_2.
[[nodiscard]] bool has_two_stiffnesses(const Problem& problem);

/// Returns EI about d1 and d2 and GJ, divided by a unit [N m^2].
[[nodiscard]] Eigen::Vector3d principal_stiffness(const Section& section, double unit);

/// Returns the strains of the stress-free shape at an arc length [1/m].
[[nodiscard]] Eigen::Vector3d natural_strain(const Problem& problem, double arc_length);

/// Returns the frame (columns d1, d2, t) of a clamp: t is the clamp's direction, and d1 is the
/// given one, made orthogonal to t and rotated about t by the clamp's roll.
[[nodiscard]] Eigen::Matrix3d held_frame(const Grip& clamp, const Eigen::Vector3d& d1);

struct OrderedGrip {
  std::size_t index;  ///< index in Problem::grips
  const Grip* grip;   ///< grip of the problem, which has to outlive this
};

[[nodiscard]] std::vector<OrderedGrip> grips_by_arc_length(const Problem& problem);

/// Returns the grips by growing arc length.
/// @throws std::invalid_argument if two are at one arc length, or as far apart as the rod between
/// them is long or farther, unless the rod stretches
[[nodiscard]] std::vector<OrderedGrip> ordered_grips(const Problem& problem);

/// Returns the index in Problem::grips of the clamp that alone carries a load, because they are
/// within 1e-9 l of each other; std::nullopt if there is no such clamp. Every other load is carried
/// by exactly one span, so that each counts once.
[[nodiscard]] std::optional<std::size_t> clamp_at_load(const Problem& problem, const Load& load);

/// Subtracts the loads on clamps from the clamps' reactions, and adds the potential of their forces
/// relative to the first of Problem::grips to the energy, because no span carries them.
void add_loads_on_clamps(const Problem& problem, Equilibrium& result);

/// Returns the arc lengths at which a shape may have kinks: ends, grips, loads, ends of sections,
/// line loads and contacts, growing [m].
[[nodiscard]] std::vector<double> kink_positions(const Problem& problem,
                                                 const std::vector<ContactPart>& contacts);

/// Converts energies from EI/l to [J]; `contact` is not converted and becomes 0.
[[nodiscard]] Energies to_joules(const Problem& problem, const Energies& own_units);

/// Moves the energy of line loads from `gravity` to `load`, because solvers treat line loads as
/// weight. It is integrated by Gauss's quadrature between the kinks of the shape. No effect on a
/// shape that cannot be sampled.
void separate_line_loads(const Problem& problem, Equilibrium& result);

}  // namespace dlo::energy_model
