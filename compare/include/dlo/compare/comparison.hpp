#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/error_budget.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/solve.hpp"

namespace dlo::compare {

/// An equilibrium of the energy model beside the one that was compared.
struct OtherState {
  bool stable = false;
  double energy_difference_J = 0;  ///< its energy minus that of the one compared
  double rms_from_compared_m = 0;
  double rms_from_force_m = 0;  ///< from the force model's shape
};

/// Which of a scene's equilibria was compared with the force model's shape: of the stable ones the
/// nearest (RMS) to where the Hookean polygon falls from the force model's shape. That is the state
/// that the force model is in, and not always the one of lowest energy.
struct ComparedState {
  double energy_J = 0;  ///< bending, gravity and loads
  int rank = 1;         ///< among the stable ones by energy, 1: the lowest
  int stable = 1;       ///< how many stable ones were found
  int unstable = 0;
  std::vector<OtherState> others;  ///< stable ones first, by energy

  /// No other stable one is as low, as a mirror image is.
  [[nodiscard]] bool only_lowest() const { return rank == 1 && stable == 1; }
};

/// One scene, both models.
struct Comparison {
  std::string scene;
  double gamma = 0;
  double length = 0;  ///< l [m]
  ForceModelSettings settings;
  Plan plan;
  Solution force;
  Shape reference;          ///< the energy model at the force model's arc lengths
  Reference reference_rod;  ///< and anywhere from 0 to l
  ComparedState state;
  Deviation deviation;
  /// The straight rod's own deviation from the reference; NaN without a straight rod.
  double undeformed_rms_over_length = 0;
  /// Against the lowest shape at each E*, which need not be the state that was compared.
  EffectiveModulus effective_modulus;
  /// What even E* does not explain, against the reference's way from the straight rod; NaN without.
  double residual_over_movement = 0;
  Budget budget;
  double energy_seconds = 0;
  long energy_evaluations = 0;
};

/// Solves a scene with the force model at rest and with the energy model, both without obstacles
/// out of reach, and compares the shapes.
/// @throws InputError, ConvergenceError
[[nodiscard]] Comparison compare(const Scene& scene, const SolveOptions& options = {},
                                 const PlanOptions& plan_options = {});

/// The straight rod of a scene with a single clamp, at arc lengths s [m], 3 x M. Several grips, or
/// a pin, leave no straight shape to start from: nothing.
[[nodiscard]] std::optional<Eigen::Matrix3Xd> straight_rod(const Scene& scene,
                                                           const std::vector<double>& s);

/// Deviation of any shape of a scene, with what the scene says about ends and straight rods.
[[nodiscard]] Deviation shape_deviation(const Scene& scene, const Shape& shape,
                                        const Reference& reference);

}  // namespace dlo::compare
