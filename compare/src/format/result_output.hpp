#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "dlo/compare/alignment.hpp"
#include "dlo/compare/check.hpp"
#include "dlo/compare/comparison.hpp"
#include "dlo/compare/force_model_fit.hpp"
#include "dlo/compare/material_fit.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"
#include "dlo/compare/solve.hpp"
#include "format/calibration_output.hpp"  // what is written of a fit too
#include "format/json.hpp"

namespace dlo::cli {

/// From which arc length to which a shape runs on its reference, in a few words.
[[nodiscard]] std::string range_text(const compare::Alignment& alignment, double length);

[[nodiscard]] std::string pose_text(const compare::RigidMotion& pose, double length);

[[nodiscard]] Json to_json(const compare::Alignment& alignment);

/// What is assumed of a scene's rod, as a sentence; empty if nothing is.
[[nodiscard]] std::string assumption_text(const compare::Scene& scene);

/// Bounds of a rod of layers, and which it is; empty of another.
[[nodiscard]] std::string layers_text(const compare::Scene& scene);

/// What a rest shape leaves of its points; empty of a scene without one.
[[nodiscard]] std::string rest_shape_text(const compare::Scene& scene);

/// A plan as a person reads it, with a blank line after it.
[[nodiscard]] std::string plan_text(const compare::Plan& plan, const compare::Scene& scene);

[[nodiscard]] Json plan_json(const compare::Plan& plan);

/// compare::shown() of each component, beside the vector's own norm.
[[nodiscard]] Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude);

/// What touches an obstacle, where and with what force, as a person reads it; obstacles count from
/// one.
[[nodiscard]] std::string contact_text(const energy_model::ContactPart& contact);

/// The same of all, by arc length; obstacles count from zero.
[[nodiscard]] Json contacts_json(const std::vector<energy_model::ContactPart>& contacts);

/// A shape as a person reads it.
[[nodiscard]] std::string solution_text(const compare::Solution& solution,
                                        const compare::Scene& scene);

[[nodiscard]] Json solution_json(const compare::Solution& solution, const compare::Scene& scene,
                                 const compare::Plan& plan);

/// The points, as `dlo check` reads them.
[[nodiscard]] std::string solution_csv(const compare::Solution& solution);

/// Returns one of several equilibria, with its forces and contacts.
/// @param number  in the order in which equilibria_text() lists them, from 1
/// @throws InputError if there are fewer
[[nodiscard]] compare::Solution numbered_equilibrium(const compare::AllSolutions& all, int number,
                                                     const compare::Scene& scene);

/// What tells several equilibria apart, and where they were looked for.
[[nodiscard]] std::string equilibria_text(const compare::AllSolutions& all,
                                          const compare::Scene& scene);

/// The first of several equilibria in full, then what tells them apart.
[[nodiscard]] Json equilibria_json(const compare::AllSolutions& all, const compare::Scene& scene,
                                   const compare::Plan& plan);

/// A comparison as a person reads it, with a blank line after it.
[[nodiscard]] std::string comparison_text(const compare::Comparison& comparison);

[[nodiscard]] Json comparison_json(const compare::Comparison& comparison);

/// The document of several.
[[nodiscard]] Json comparisons_json(const std::vector<compare::Comparison>& comparisons);

/// One line a comparison.
[[nodiscard]] std::string comparisons_csv(const std::vector<compare::Comparison>& comparisons);

/// Rows of a shape's distance from another one: RMS and largest, up to where that is; the angles.
void add_largest_and_rms(std::string& out, const compare::Deviation& d);
void add_angle_and_curvature(std::string& out, const compare::Deviation& d);

/// Which equilibrium was compared and which others there are.
/// @param length  of the rod [m];  @param shape  what the shape that was compared is called
void add_state(std::string& out, const compare::ComparedState& state, double length,
               const char* shape);

/// The lines about E*/E.
/// @param movement_m  RMS way of the rod from straight [m], NaN without
/// @param of  what E stands for;  @param value  its E*, to be printed; NaN if not
void add_modulus(std::string& out, const compare::EffectiveModulus& modulus, double movement_m,
                 const compare::NamedValue& of, double value);

/// A judged shape for the page.
struct CheckPage {
  const compare::CheckResult& result;
  std::string unit_hint = {};  ///< where the check itself has none
  std::string verdict = {};    ///< its word where that is shown otherwise, as in colour
};

[[nodiscard]] std::string shape_check_text(const CheckPage& page);

[[nodiscard]] Json shape_check_json(const compare::CheckResult& report);

/// A summary for a page of Markdown, such as that of a job of continuous integration.
[[nodiscard]] std::string shape_check_markdown(const compare::CheckResult& report);

[[nodiscard]] std::string shape_check_csv(const compare::CheckResult& report);

[[nodiscard]] std::string force_model_text(const compare::ForceModelFit& fit,
                                           bool target_was_given);
[[nodiscard]] std::string force_model_csv(const compare::ForceModelFit& fit);
[[nodiscard]] Json force_model_json(const compare::ForceModelFit& fit);
/// A parameters file for --parameters and for programs of the user's own.
[[nodiscard]] std::string force_model_toml(const compare::ForceModelFit& fit);

[[nodiscard]] std::string material_text(const compare::Calibration& report);
[[nodiscard]] std::string material_csv(const compare::Calibration& report);
[[nodiscard]] Json material_json(const compare::Calibration& report);

}  // namespace dlo::cli
