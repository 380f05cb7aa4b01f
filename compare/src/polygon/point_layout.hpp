#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/scene.hpp"
#include "dlo/force_model/grip.hpp"

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

}  // namespace dlo::compare
