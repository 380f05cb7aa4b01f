#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/compared_state.hpp"
#include "dlo/compare/deviation.hpp"
#include "dlo/compare/effective_modulus.hpp"
#include "dlo/compare/error_budget.hpp"
#include "dlo/compare/force_model_settings.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// One scene, both models.
struct Comparison {
  std::string scene;            ///< its name
  double gamma = 0;             ///< w l^3 / (EI) [-]
  double length = 0;            ///< l [m]
  NamedValue stiffness;         ///< Scene::stiffness
  ForceModelSettings settings;  ///< of the force model, as used
  std::optional<Plan> plan;     ///< what the scene needs, if that was asked
  Solution force;               ///< the force model at rest
  Shape reference;              ///< the energy model at the force model's arc lengths
  Reference reference_rod;      ///< and anywhere from 0 to l
  std::vector<energy_model::ContactPart> contacts;  ///< of the reference, as Solution::contacts
  /// Why nothing may be concluded from the reference; empty if it is proven. Only where
  /// SolveOptions::accept_unverified is set.
  std::string unverified;
  /// Which equilibrium `reference` is: of the stable ones the nearest (RMS) to where the Hookean
  /// polygon goes downhill from the force model's shape. That is the state that the force model is
  /// in, and not always the one of lowest energy.
  ComparedState state;
  Deviation deviation;  ///< of `force` from `reference`
  /// The straight rod's own deviation from the reference; NaN without a straight rod.
  double undeformed_rms_over_length = 0;
  /// In the state that was compared, followed to each E*; none if it was not searched or the
  /// reference is not verified.
  EffectiveModulus effective_modulus;
  /// What even E* does not explain, against the reference's way from the straight rod; NaN without.
  double residual_over_movement = 0;
  Budget budget;                ///< where the deviation comes from
  double energy_seconds = 0;    ///< of the energy model's solver [s]
  long energy_evaluations = 0;  ///< of the energy model's solver
};

/// Solves a scene with the force model at rest and with the energy model, both without obstacles
/// out of reach, and compares the shapes.
/// @param plan  makes a plan as well, which costs as much as some ten solves
/// @throws InputError, ConvergenceError
[[nodiscard]] Comparison compare(const Scene& scene, const SolveOptions& options = {},
                                 const std::optional<PlanOptions>& plan = std::nullopt,
                                 ModulusSearch modulus = ModulusSearch::yes);

}  // namespace dlo::compare
