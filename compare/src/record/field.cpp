#include "record/field.hpp"

#include "base/quote.hpp"

namespace dlo::compare {

Json json_of(const Numbers& numbers) {
  Json object = Json::object();
  for (const auto& [name, value] : numbers) object[name] = value;
  return object;
}

std::string csv_value(const Json& value, int digits) {
  if (value.is_null()) return "";
  if (value.is_number_float()) return csv_number(value.get<double>(), digits);
  return value.is_string() ? csv_field(value.get<std::string>()) : value.dump();
}

double Magnitudes::of(std::string_view unit) const {
  if (unit == "m") return length;
  if (unit == "N") return force;
  if (unit == "Nm") return torque;
  return unit == "J" ? energy : 0;
}

Magnitudes magnitudes(const Scene& scene) {
  const double l = scene.length;
  const double force = scene.softer_bending_stiffness() / (l * l) +
                       scene.weight_between(0, l).norm() + scene.total_load_magnitude();
  return {.length = l, .force = force, .torque = force * l, .energy = force * l};
}

Json picked(const Json& document, std::initializer_list<std::string_view> paths) {
  Json result = Json::object();
  for (const std::string_view path : paths) {
    const Json::json_pointer at("/" + std::string(path));
    if (document.contains(at)) result[at] = document.at(at);
  }
  return result;
}

Json to_json(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json points_json(const Eigen::Matrix3Xd& points) {
  return json_list(points.colwise(), [](const Eigen::Vector3d& point) { return to_json(point); });
}

}  // namespace dlo::compare
