#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dlo/compare/error.hpp"

namespace dlo::compare {

/// Physical dimension of a number in a scene file; it determines which units may follow.
enum class Dimension {
  number,
  length,
  angle,
  pressure,
  density,
  force,
  torque,
  force_per_length,
  acceleration,
  velocity,
  curvature,
  foundation,         ///< force per depth and per length of rod
  section_stiffness,  ///< moment per curvature (EI), torque per twist (GJ)
  joint_stiffness,    ///< moment per angle
  mass,
  mass_per_length,
  twist,  ///< angle per length
  time,
  frequency,
};

/// Returns the dimension with an enumerator's name; std::nullopt if there is none.
[[nodiscard]] std::optional<Dimension> dimension_named(std::string_view name);

/// Returns the names of the units of a dimension, SI first.
[[nodiscard]] std::vector<std::string> unit_names(Dimension dimension);

/// Returns the names of the units of a dimension as a list for messages.
[[nodiscard]] std::string known_units(Dimension dimension);

/// A quantity without a known unit; the message lists all that is allowed.
class UnitError : public InputError {
  using InputError::InputError;
};

/// Returns the value in SI units of "210 GPa", "2 mm" or "-175 deg". A unit is required, except for
/// Dimension::number, which has none.
/// @throws InputError without the file's name: the error and what is allowed
[[nodiscard]] double parse_quantity(std::string_view text, Dimension dimension);

/// Returns the error of a number of a file [SI] that is larger than its dimension allows, or an
/// empty text. Larger numbers have no physical meaning and overflow in sums of squares. Pressure
/// and section_stiffness have no limit here: the reader checks E I and E A of the rod.
[[nodiscard]] std::string magnitude_problem(double value, Dimension dimension);

}  // namespace dlo::compare
