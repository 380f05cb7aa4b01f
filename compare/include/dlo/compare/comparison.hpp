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

/// Comparison of the force model with the energy model in one scene.
struct Comparison {
  std::string scene;            ///< name of the scene
  double gamma = 0;             ///< w l^3 / (EI) [-]
  double length = 0;            ///< l [m]
  NamedValue stiffness;         ///< Scene::stiffness
  ForceModelSettings settings;  ///< settings of the force model, as used
  std::optional<Plan> plan;     ///< requirements of the scene, if requested
  Solution force;               ///< the force model at rest
  Shape reference;              ///< the energy model at the force model's arc lengths
  Reference reference_rod;      ///< the energy model at any arc length from 0 to l
  /// Contacts of the reference, as Solution::contacts.
  std::vector<energy_model::ContactPart> contacts;
  /// Reason why no conclusion may be drawn from the reference; empty if it is verified. Given only
  /// if SolveOptions::accept_unverified is set.
  std::string unverified;
  /// The equilibrium that `reference` is. Of the stable ones it is the nearest (RMS) to the shape
  /// to which the Hookean polygon descends from the force model's shape. The force model is then on
  /// the same branch, which does not always have the lowest energy.
  ComparedEquilibrium state;
  Deviation deviation;  ///< deviation of `force` from `reference`
  /// RMS deviation of the straight rod from the reference, divided by the length; NaN without a
  /// straight rod.
  double undeformed_rms_over_length = 0;
  /// E*/E on the branch of the compared equilibrium, followed to each E*; none if it was not
  /// searched or the reference is not verified.
  EffectiveModulus effective_modulus;
  /// RMS deviation that remains at E*, divided by the RMS displacement of the reference from the
  /// straight rod; NaN without a straight rod or without E*.
  double residual_over_displacement = 0;
  Budget budget;                ///< causes of the deviation
  double energy_seconds = 0;    ///< time of the energy model's solver [s]
  long energy_evaluations = 0;  ///< evaluations of the energy model's solver
};

/// Solves a scene with the force model at rest and with the energy model, both without obstacles
/// out of reach, and compares the shapes.
/// @param plan  options of a plan, which costs as much as about ten solves; empty: no plan
/// @throws InputError, ConvergenceError
[[nodiscard]] Comparison compare(const Scene& scene, const SolveOptions& options = {},
                                 const std::optional<PlanOptions>& plan = std::nullopt,
                                 ModulusSearch modulus = ModulusSearch::yes);

}  // namespace dlo::compare
