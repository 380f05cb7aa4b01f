#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dlo::compare {

/// How the values of a range are spread.
enum class Spacing { list, linear, logarithmic };

/// One field of a scene and the values it takes.
struct Axis {
  std::string field;  ///< dotted path such as rod.material.youngs_modulus or gripper.0.direction
  Spacing spacing = Spacing::list;  ///< how `values` or the range are meant
  std::vector<std::string> values;  ///< of a list, as a scene file spells them
  double first = 0;                 ///< of a range, in `unit`
  double last = 0;                  ///< of a range, in `unit`
  std::string unit;                 ///< of a range or of all numbers of a list; may be empty
  std::int64_t count = 0;           ///< of values

  /// Value `index`, 0 <= index < count, without the unit. Values inside a range are rounded to 12
  /// significant digits, so that they are the same on every machine and 0.3 is not
  /// 0.30000000000000004.
  [[nodiscard]] std::string number(std::int64_t index) const;
  /// The same with its unit, as a scene file spells it.
  [[nodiscard]] std::string value(std::int64_t index) const;
  /// Name of a column: the field, and the unit in brackets if there is one.
  [[nodiscard]] std::string column() const;
};

/// Reads FIELD=VALUES. VALUES is a list a,b,c (commas in brackets belong to a vector), or a range
/// lin:a:b:n or log:a:b:n of n >= 2 values from a to b, ends included. Numbers may have a unit, in
/// a range the same at both ends. A list whose values all have the same unit is stored without it.
/// @throws InputError that names the text and what is allowed
[[nodiscard]] Axis parse_axis(const std::string& text);

/// All combinations of the values of some fields; the last field changes fastest. It stores the
/// axes only, never the combinations.
class Grid {
 public:
  Grid() = default;
  /// @throws InputError if a field comes twice or inside another, or if there are more than 1e15
  /// combinations
  explicit Grid(std::vector<Axis> axes);

  /// How many combinations.
  [[nodiscard]] std::int64_t size() const { return size_; }
  /// As given.
  [[nodiscard]] const std::vector<Axis>& axes() const { return axes_; }
  /// Which value each axis takes in combination `row`, 0 <= row < size().
  [[nodiscard]] std::vector<std::int64_t> indices(std::int64_t row) const;

 private:
  std::vector<Axis> axes_;
  std::int64_t size_ = 1;
};

}  // namespace dlo::compare
