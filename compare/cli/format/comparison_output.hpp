#pragma once

#include <string>
#include <vector>

#include "dlo/compare/comparison.hpp"
#include "format/json.hpp"

namespace dlo::cli {

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

}  // namespace dlo::cli
