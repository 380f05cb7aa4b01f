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

/// Where the points of a scene's polygon lie along its rod.
struct Layout {
  double segment_length = 0;  ///< L, of the held segments and about that of all others [m]
  Eigen::VectorXd rest_lengths;
  std::vector<double> arc_length;        ///< of the points [m]
  std::vector<Eigen::Index> first_held;  ///< first point that each of the scene's grippers holds
  std::vector<std::size_t> along;        ///< the grippers in the order of their arc lengths
};

/// The scene's grippers in the order of their arc lengths. @throws InputError naming file, line and
/// key if two hold one arc length, or are further apart than the rod between them
[[nodiscard]] std::vector<std::size_t> order_along(const Scene& scene);

/// What a rod that does not stretch needs; of one that does the solver says it. @throws InputError
/// as order_along, and if the rod between two grippers would be taut
void require_slack(const Scene& scene);

/// Lays out points as `discretise` says. @throws InputError as it does
[[nodiscard]] Layout lay_out(const Scene& scene, const ForceModelSettings& settings);

/// What a scene's grippers hold of its polygon, one each.
[[nodiscard]] std::vector<force_model::Grip> grips_of(const Scene& scene, const Layout& layout);

/// Few points have long held segments, which may leave too little rod between two grips, or a
/// single segment that would have to be shorter than it is. @throws InputError then, saying how
/// many points do. @param grips  of grips_of()
void require_fit(const Scene& scene, const ForceModelSettings& settings, const Layout& layout,
                 const std::vector<force_model::Grip>& grips);

/// What the points of a scene's polygon weigh, by point [kg].
struct PointMasses {
  std::vector<double> rod;      ///< of the rod
  std::vector<double> hanging;  ///< what hangs on it (PointLoad::mass), by the lever rule
};

/// @throws InputError as discretise()
[[nodiscard]] PointMasses point_masses(const Scene& scene, const ForceModelSettings& settings);

/// To which side of the line between two grips their slack hangs.
enum class Side {
  along_load,
  against_load,
};

/// A curve through all grips with the right length between them, to start a search or a simulation
/// from [m], 3 x M. Beyond the outermost grips it is straight. Between two it is a cubic with the
/// grips' directions (a pin's is that of the line between its neighbours) and, while that is
/// shorter than the rod, an arch with no slope at the grips towards the load across their line. Of
/// a rod without such a load the arch follows the clamps' directions, or else +x (+y if the grips
/// lie along x). Every arch
/// leaves its plane by a millionth of its length, so that what is unstable out of plane leaves it.
/// No two neighbouring points coincide.
/// @param along  the grippers in the order of their arc lengths
[[nodiscard]] Eigen::Matrix3Xd start_shape(const Scene& scene,
                                           const std::vector<std::size_t>& along,
                                           const std::vector<double>& arc_length, Side side);

/// Turns the parts of a start beyond its outermost grips out of the obstacles: where a segment
/// would enter one it lies along its face, at its own length.
/// @param rod  its grips, walls and solids count;  @param[in,out] points  [m], 3 x M
void keep_free_ends_clear(const force_model::Rod& rod, Eigen::Ref<Eigen::Matrix3Xd> points);

/// Table 1's c_F as a share of the largest stable step, L/(2 c_c); no formula in the paper gives
/// it.
inline constexpr double table_1_step_share = 0.86;
/// The same in words.
inline constexpr const char* table_1_step_formula = "c_F = 0.86 L/(2 c_c)";
/// Table 1's l_s as a share of L.
inline constexpr double table_1_limit_share = 0.6;
/// c_h of the stepper `dynamic`, which the paper leaves open.
inline constexpr double dynamic_share = 0.9;

/// Time step of the stepper `verlet` as a share of the largest stable one, 2/omega_max, of the rod
/// where it starts: bent joints and compressed segments are stiffer than straight ones.
inline constexpr double verlet_step_share = 0.5;

/// The stepper a scene asks for; what it does not give is in Table 1's proportions. That of
/// `verlet` takes verlet_step_share and damps the slowest mode, as mode_bounds estimates it,
/// critically; `implicit` takes no masses. @throws InputError if it lacks a constant that its
/// stepper needs
[[nodiscard]] force_model::StepOptions step_options(const ForceModelSettings& settings,
                                                    const Discretisation& discretisation);

/// Gives the rod of a discretisation its points' masses, if the stepper asks for them.
/// @throws InputError as discretise()
void set_masses(const Scene& scene, const ForceModelSettings& settings,
                Discretisation& discretisation);

}  // namespace dlo::compare
