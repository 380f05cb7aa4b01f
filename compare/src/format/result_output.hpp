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
#include "format/calibration_output.hpp"  // also needed for the output of fits
#include "format/json.hpp"
#include "record/csv_table.hpp"

namespace dlo::cli {

[[nodiscard]] std::string pose_text(const compare::RigidMotion& pose, double length);

[[nodiscard]] Json to_json(const compare::Alignment& alignment);

/// Returns a plan for people, with a blank line after it.
[[nodiscard]] std::string plan_text(const compare::Plan& plan, const compare::Scene& scene);

[[nodiscard]] Json plan_json(const compare::Plan& plan);

/// Returns compare::shown() of each component, in comparison with `magnitude` and the vector's own
/// norm.
[[nodiscard]] Eigen::Vector3d shown(const Eigen::Vector3d& vector, double magnitude);

/// Returns all contacts, by arc length; obstacles count from 0.
[[nodiscard]] Json contacts_json(const std::vector<energy_model::ContactPart>& contacts);
/// Makes the obstacles of a list of contacts count from 1, as in texts.
void count_from_1(Json& contacts);

/// Describes a solution for people.
[[nodiscard]] std::string solution_text(const compare::Solution& solution,
                                        const compare::Scene& scene);

[[nodiscard]] Json solution_json(const compare::Solution& solution, const compare::Scene& scene,
                                 const compare::Plan& plan);

/// Returns the points, with d1 if the solution has a frame, in the format that `dlo check` reads.
[[nodiscard]] std::string solution_csv(const compare::Solution& solution);

/// Returns one of several equilibria, with its forces and contacts.
/// @param number  in the order in which equilibria_text() lists them, from 1
/// @throws InputError if there are fewer
[[nodiscard]] compare::Solution numbered_equilibrium(const compare::AllSolutions& all, int number,
                                                     const compare::Scene& scene);

/// Describes how several equilibria differ, and which start shapes were used.
[[nodiscard]] std::string equilibria_text(const compare::AllSolutions& all,
                                          const compare::Scene& scene);

/// Returns the document of the first of several equilibria, with a list of all of them: stability,
/// energy and points of each.
[[nodiscard]] Json equilibria_json(const compare::AllSolutions& all, const compare::Scene& scene,
                                   const compare::Plan& plan);

/// Whether the force model's RMS deviation is within default_tolerance().
[[nodiscard]] bool within_limit(const compare::Comparison& comparison);

/// Describes a comparison for people, with a blank line after it. Its first line is a verdict, with
/// the largest part of the error budget if the deviation is not within_limit().
[[nodiscard]] std::string comparison_text(const compare::Comparison& comparison);

[[nodiscard]] Json comparison_json(const compare::Comparison& comparison);

[[nodiscard]] Json comparisons_json(const std::vector<compare::Comparison>& comparisons);

/// Returns a header, then one line per comparison.
[[nodiscard]] std::string comparisons_csv(const std::vector<compare::Comparison>& comparisons);

/// Adds the RMS distance of a shape from another, the largest distance and its position, without a
/// line break at the end.
void add_largest_and_rms(std::string& out, const compare::Deviation& d);

/// Adds the lines about E*/E.
/// @param movement_m  RMS displacement of the rod from straight [m], NaN without
/// @param of  quantity that E stands for;  @param value  its E*, to be printed; NaN: not printed
void add_modulus(std::string& out, const compare::EffectiveModulus& modulus, double movement_m,
                 const compare::NamedValue& of, double value);

/// A verdict on a shape for a page.
struct CheckPage {
  const compare::CheckResult& result;
  std::string unit_hint = {};  ///< used if the check itself has no hint
  std::string verdict = {};    ///< word for the verdict, if it is shown otherwise, as in colour
};

[[nodiscard]] compare::Document shape_check_document(const CheckPage& page);

/// Returns a text as one cell of a Markdown table, with the characters \`*_[]<>|#& escaped.
[[nodiscard]] std::string markdown(const std::string& text);

/// Returns a summary in Markdown, such as for a job of continuous integration.
[[nodiscard]] std::string shape_check_markdown(const compare::CheckResult& report);

[[nodiscard]] compare::Document force_model_document(const compare::ForceModelFit& fit,
                                                     bool target_was_given);
[[nodiscard]] std::string force_model_csv(const compare::ForceModelFit& fit);
/// Returns a parameters file for --parameters and for other programs.
[[nodiscard]] std::string force_model_toml(const compare::ForceModelFit& fit);

[[nodiscard]] compare::Document material_document(const compare::Calibration& report);

}  // namespace dlo::cli
