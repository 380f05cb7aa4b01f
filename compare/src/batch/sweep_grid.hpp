#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dlo::compare {

/// Spacing of the values of an axis: a list, or a linear or logarithmic range.
enum class Spacing { list, linear, logarithmic };

/// One field of a scene and the values that it takes.
struct Axis {
  std::string field;  ///< dotted path such as rod.material.youngs_modulus or gripper.0.direction
  Spacing spacing = Spacing::list;  ///< list, or the kind of range
  std::vector<std::string> values;  ///< values of a list, as a scene file spells them, less `unit`
  double first = 0;                 ///< first value of a range, in `unit`
  double last = 0;                  ///< last value of a range, in `unit`
  std::string unit;                 ///< unit of a range or of all numbers of a list; may be empty
  std::int64_t count = 0;           ///< number of values

  /// Returns value `index`, 0 <= index < count, without the unit. Values inside a range are rounded
  /// to 12 significant digits, so that they are equal on every machine and 0.3 is not
  /// 0.30000000000000004.
  [[nodiscard]] std::string number(std::int64_t index) const;
  /// Returns value `index`, 0 <= index < count, with its unit, as a scene file spells it.
  [[nodiscard]] std::string value(std::int64_t index) const;
  /// Returns the name of the table's column: the field, followed by the unit in brackets if there
  /// is one.
  [[nodiscard]] std::string column() const;
};

/// Reads FIELD=VALUES. VALUES is a list a,b,c (commas in brackets belong to a vector), or a range
/// lin:a:b:n or log:a:b:n of n >= 2 values from a to b, ends included. Numbers may have a unit, in
/// a range the same at both ends. A list whose values all have the same unit is stored without it.
/// @throws InputError that names the text and what is allowed
[[nodiscard]] Axis parse_axis(const std::string& text);

/// All combinations of the values of some fields; the last field changes fastest. Only the axes are
/// stored, never the combinations.
class Grid {
 public:
  Grid() = default;
  /// Creates the grid of the axes. @throws InputError if a field occurs twice or is part of another
  /// one, or if there are more than 1e15 combinations
  explicit Grid(std::vector<Axis> axes);

  /// Returns the number of combinations.
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// Returns the axes in the order given.
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
  /// Returns the index of each axis's value in combination `row`, 0 <= row < size().
  [[nodiscard]] std::vector<std::int64_t> indices(std::int64_t row) const;

 private:
  std::vector<Axis> axes_;
  std::int64_t size_ = 1;
};

}  // namespace dlo::compare
