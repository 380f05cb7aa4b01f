#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/force_model/grip.hpp"
#include "dlo/force_model/rod.hpp"
#include "dlo/force_model/stepper.hpp"

namespace dlo::compare {

/// Positions of the points of a scene's polygon along its rod.
struct Layout {
  double segment_length = 0;  ///< L, length of the held segments, and roughly of all others [m]
  Eigen::VectorXd rest_lengths;
  std::vector<double> arc_length;        ///< arc lengths of the points [m]
  std::vector<Eigen::Index> first_held;  ///< index of the first point that each of the scene's
                                         ///< grippers holds
  std::vector<std::size_t> along;  ///< indices of the grippers in the order of their arc lengths
};

/// Checks that a rod without stretch has slack between its grippers. A rod that counts stretch is
/// left to its solver, and a rod that is taut on a line to taut_line().
/// @throws InputError as order_along, and if the rod between two grippers would be taut
void require_slack(const Scene& scene);

/// Computes the positions of the points by the rules of `discretise`.
/// @throws InputError as order_along, and if there are too few points
[[nodiscard]] Layout lay_out(const Scene& scene, const ForceModelSettings& settings);

/// Returns the grips of the polygon, one for each gripper of the scene.
[[nodiscard]] std::vector<force_model::Grip> grips_of(const Scene& scene, const Layout& layout);

/// Checks that the held segments leave enough rod between neighbouring grips. With few points held
/// segments are long: they may leave too little rod, or a single segment that would have to be
/// shortened.
/// @throws InputError with the number of points that suffices, or without a number if more than
/// 3000 further points would be needed
/// @param grips  result of grips_of()
void require_feasible_grips(const Scene& scene, const ForceModelSettings& settings,
                            const Layout& layout, const std::vector<force_model::Grip>& grips);

/// Masses of the points of a scene's polygon, by point [kg].
struct PointMasses {
  Eigen::VectorXd rod;      ///< mass of the rod
  Eigen::VectorXd hanging;  ///< mass hanging on it (PointLoad::mass), by the lever rule
};

/// Returns the masses of the points. @throws InputError in the cases of discretise()
[[nodiscard]] PointMasses point_masses(const Scene& scene, const ForceModelSettings& settings);

/// Side of the line between two grips to which the slack between them hangs.
enum class Side {
  along_load,
  against_load,
};

/// Returns a curve through all grips with the right length between them [m], 3 x M, from which a
/// search or a simulation starts. Beyond the outermost grips it is straight. Between two it is a
/// cubic with the grips' directions (a pin takes the direction of the line between its neighbours,
/// a single pin that of the load after it, or else +x) and, if the cubic is shorter than the rod,
/// an additional arch with zero slope at the grips, in the direction of the load across the line
/// between them. Without such a load the arch follows the clamps' directions, or else +x (+y if the
/// grips lie along x). Every arch leaves its plane by a millionth of its length, so that a search
/// can leave a shape that is unstable out of plane. No two neighbouring points coincide.
/// @param along  indices of the grippers in the order of their arc lengths
[[nodiscard]] Eigen::Matrix3Xd start_shape(const Scene& scene,
                                           const std::vector<std::size_t>& along,
                                           const std::vector<double>& arc_length, Side side);

/// Rotates the parts of a start beyond its outermost grips out of the obstacles: a segment that
/// would enter an obstacle keeps its length and lies along the obstacle's surface.
/// @param rod  defines grips, walls and solids;  @param[in,out] points  [m], 3 x M
void keep_free_ends_clear(const force_model::Rod& rod, Eigen::Ref<Eigen::Matrix3Xd> points);

/// Ratio of Table 1's c_F to the largest stable step, L/(2 c_c) with L = l/N; the paper has no
/// formula for it.
inline constexpr double table_1_step_share = 0.86;
/// Formula of c_F with table_1_step_share, as text.
inline constexpr const char* table_1_step_formula = "c_F = 0.86 L/(2 c_c)";
/// Ratio of Table 1's l_s to L = l/N.
inline constexpr double table_1_limit_share = 0.6;
/// Default c_h of the stepper `dynamic`, which the paper does not specify.
inline constexpr double dynamic_share = 0.9;

/// Time step of the stepper `verlet`, divided by the largest stable one, 2/omega_max, of the rod at
/// its start. The margin is needed because bent joints and compressed segments are stiffer than
/// straight ones.
inline constexpr double verlet_step_share = 0.5;

/// Returns the stepper that a scene selects. If the scene does not give them, c_F and l_s have
/// Table 1's proportions and c_h is dynamic_share; an automatic stepper chooses them itself. The
/// stepper `verlet` takes verlet_step_share and damps the slowest mode, as mode_bounds estimates
/// it, critically; `implicit` needs no masses.
[[nodiscard]] force_model::StepOptions step_options(const ForceModelSettings& settings,
                                                    const Discretisation& discretisation);

/// Sets the masses of a discretisation's points, if the stepper needs them.
/// @throws InputError in the cases of discretise()
void set_masses(const Scene& scene, const ForceModelSettings& settings,
                Discretisation& discretisation);

}  // namespace dlo::compare
