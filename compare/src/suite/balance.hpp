#pragma once

#include <optional>

#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape.hpp"

namespace dlo::compare {

/// How far a shape is from balance.
struct MomentBalance {
  double imbalance = 0;  ///< share of its bending moments that nothing explains [-]
  double stiffness = 1;  ///< c, over EI
  double weight = 1;     ///< a, over the scene's; 1 unless there is weight and another load
  /// Share of the moments that is not identifiable from points at such distances: curvatures of a
  /// rod in which forces F bend layers of sqrt(EI / F) are found to a quarter of h^2 F / EI, EI
  /// being the scene's or, if that is less, the shape's [-]
  double resolution = 0;
};

/// The share of a shape's bending moments that neither its loads nor forces and torques of the
/// grippers at its ends explain, whatever the stiffness and the weight are,
///     min over c, a, M, F of |c EI kappa_i - a w_i - m_i - M - (P_n - P_i) x F| / |c EI kappa_i|,
/// w_i and m_i the moments about P_i of the weight and of the loads beyond it. At rest it is an
/// error of discretisation. Nothing where the scene has more than a round, straight rod of one
/// section, held at its ends alone.
/// @param shape  in the scene's frame, along the whole rod
/// @param power  of springs whose moments go with a power of 2 sin(angle / 2), > 0; 1: EI kappa
[[nodiscard]] std::optional<MomentBalance> moment_balance(const Scene& scene, const Shape& shape,
                                                          double power = 1);

}  // namespace dlo::compare
