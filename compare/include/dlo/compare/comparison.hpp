#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {

/// Where a deviation comes from, each part found by switching one thing [m, RMS]. The parts are
/// vectors along the rod that add up to the total; their RMS values add up only if they are alike.
struct Budget {
  double law = 0;             ///< chain with this law against chain with hooke
  double bookkeeping = 0;     ///< hooke chain with this bookkeeping against the consistent one
  double discretisation = 0;  ///< consistent hooke chain against the continuous rod
  double stretch = 0;         ///< force model at rest against the chain, whose own c_c is AE
  double not_at_rest = 0;     ///< estimated distance of the force model from rest
};

/// One scene, both models.
struct Comparison {
  std::string scene;
  double gamma = 0;
  ForceModelSettings settings;
  Solution force;
  Shape reference;  ///< the energy model at the force model's arc lengths
  Deviation deviation;
  /// The straight rod's own deviation from the reference; NaN without a straight rod.
  double undeformed_rms_over_length = 0;
  EffectiveModulus effective_modulus;
  Budget budget;
  double energy_seconds = 0;
  long energy_evaluations = 0;
};

/// Solves a scene with the force model at rest and with the energy model and compares the shapes.
/// @throws InputError, ConvergenceError
[[nodiscard]] Comparison compare(const Scene& scene, const SolveOptions& options = {});

/// The straight rod of a scene with a single clamp, at arc lengths s [m], 3 x M. Several grips, or
/// a pin, leave no straight shape to start from: nothing.
[[nodiscard]] std::optional<Eigen::Matrix3Xd> straight_rod(const Scene& scene,
                                                           const std::vector<double>& s);

/// Deviation of any shape of a scene, with what the scene says about ends and straight rods.
[[nodiscard]] Deviation shape_deviation(const Scene& scene, const Shape& shape,
                                        const Reference& reference);

}  // namespace dlo::compare
