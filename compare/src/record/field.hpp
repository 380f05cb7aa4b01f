#pragma once

#include <Eigen/Core>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "dlo/compare/scene.hpp"

namespace dlo::compare {

using Json = nlohmann::ordered_json;

/// Numbers with their names, in order.
using Numbers = std::vector<std::pair<std::string, double>>;

/// Outputs that show a field; combined by |.
enum FieldPlace : unsigned {
  in_json = 1,    ///< in JSON documents, at its path
  in_csv = 2,     ///< in CSV tables, as a column
  in_python = 4,  ///< in Python, as an attribute
  everywhere = in_json | in_csv | in_python
};

/// Description of one quantity of a result T. Its key in JSON, its column in CSV, its attribute in
/// Python with the line of the stub, and its row in a page's table of keys are generated from it.
template <typename T>
struct Field {
  /// Function that returns the value; NaN means that there is none.
  using Get =
      std::variant<double (*)(const T&), long (*)(const T&), bool (*)(const T&),
                   std::string (*)(const T&), std::vector<std::string> (*)(const T&),
                   std::vector<double> (*)(const T&), Numbers (*)(const T&), Json (*)(const T&)>;

  std::string_view name = {};   ///< words joined by "_"
  std::string_view unit = {};   ///< unit as it ends the key; empty: a pure number, or no number
  std::string_view words = {};  ///< description for people
  Get get = {};
  unsigned places = everywhere;  ///< combination of FieldPlace
  std::string_view path = {};    ///< path in JSON, such as "solver/wall_s"; empty: key()
  /// Whether a scene has the field; null: all scenes have it.
  bool (*when)(const Scene&) = nullptr;

  /// Returns name and unit, as in the title of a column.
  [[nodiscard]] std::string key() const {
    return std::string(name) + (unit.empty() ? "" : "_") + std::string(unit);
  }
  [[nodiscard]] std::string json_path() const { return path.empty() ? key() : std::string(path); }
  /// Returns the description with its unit.
  [[nodiscard]] std::string python_words() const {
    return std::string(words) + (unit.empty() ? "." : " [" + std::string(unit) + "].");
  }
};

/// Converts a field's value to JSON.
[[nodiscard]] Json json_of(const Numbers& numbers);
template <typename Value>
[[nodiscard]] Json json_of(const Value& value) {
  return Json(value);
}

template <typename T>
[[nodiscard]] Json value_of(const Field<T>& field, const T& result) {
  return std::visit([&](auto get) { return json_of(get(result)); }, field.get);
}

/// Returns the values of the fields of type double, by their keys.
template <typename T>
[[nodiscard]] Numbers numbers_of(std::span<const Field<T>> fields, const T& result) {
  Numbers numbers;
  for (const Field<T>& field : fields) {
    if (const auto* get = std::get_if<double (*)(const T&)>(&field.get)) {
      numbers.emplace_back(field.key(), (*get)(result));
    }
  }
  return numbers;
}

/// Adds the fields of JSON to a document, at their paths.
template <typename T>
void add_json(Json& document, std::span<const Field<T>> fields, const T& result,
              const Scene& scene) {
  for (const Field<T>& field : fields_in(in_json, fields, scene)) {
    document[Json::json_pointer("/" + field.json_path())] = value_of(field, result);
  }
}

/// Returns a value for CSV; a missing value leaves its field empty.
[[nodiscard]] std::string csv_value(const Json& value, int digits = 10);

/// Returns the fields that an output shows for a scene.
template <typename T>
[[nodiscard]] std::vector<Field<T>> fields_in(FieldPlace place, std::span<const Field<T>> fields,
                                              const Scene& scene) {
  std::vector<Field<T>> chosen;
  for (const Field<T>& field : fields) {
    const bool applies = field.when == nullptr || field.when(scene);
    if (applies && (field.places & place) != 0) chosen.push_back(field);
  }
  return chosen;
}

/// Magnitudes of a scene's results: values far below them are rounding (shown()).
struct Magnitudes {
  double length = 0;  ///< l [m]
  double force = 0;   ///< sum of the weight, the loads and the smaller EI/l^2 [N]
  double torque = 0;  ///< `force` times l [N m]
  double energy = 0;  ///< `force` times l [J]

  /// Returns the magnitude of quantities with a unit: m, N, Nm or J; 0 for other units.
  [[nodiscard]] double of(std::string_view unit) const;
};

[[nodiscard]] Magnitudes magnitudes(const Scene& scene);

/// Returns a list of the results of `make` for each element.
template <typename List, typename Make>
[[nodiscard]] Json json_list(const List& list, const Make& make) {
  Json result = Json::array();
  for (const auto& element : list) result.push_back(make(element));
  return result;
}

/// Returns the result of `make`; null without a value.
template <typename Value, typename Make>
[[nodiscard]] Json json_or_null(const std::optional<Value>& value, const Make& make) {
  return value ? Json(make(*value)) : Json();
}

template <typename Value>
[[nodiscard]] Json json_or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}
[[nodiscard]] inline Json text_or_null(const std::string& text) {
  return text.empty() ? Json() : Json(text);
}

/// Returns the parts of a document at paths such as "seen/share", as far as it has them.
[[nodiscard]] Json picked(const Json& document, std::initializer_list<std::string_view> paths);

[[nodiscard]] Json to_json(const Eigen::Vector3d& vector);
[[nodiscard]] Json points_json(const Eigen::Matrix3Xd& points);

}  // namespace dlo::compare
