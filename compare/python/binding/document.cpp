#include "document.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "dlo/compare/error.hpp"

namespace dlo::python {
namespace {

toml::array list_from(const py::handle& list, const std::string& path);

/// Puts a value where `place(value)` wants it.
template <typename Place>
void place_value(const py::handle& value, const std::string& path, const Place& place) {
  if (py::isinstance<py::bool_>(value)) return place(value.cast<bool>());
  if (py::isinstance<py::str>(value)) return place(value.cast<std::string>());
  if (py::isinstance<py::dict>(value)) {
    return place(to_toml(py::reinterpret_borrow<py::dict>(value), path));
  }
  if (py::isinstance<py::float_>(value)) return place(value.cast<double>());
  const bool is_array = py::hasattr(value, "tolist");  // of NumPy, and its single numbers
  if (is_array) return place_value(value.attr("tolist")(), path, place);
  if (PyIndex_Check(value.ptr()) != 0) {
    const py::int_ integer(py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr())));
    return place(integer.cast<std::int64_t>());
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    return place(list_from(value, path));
  }
  throw compare::InputError(
      fmt::format("scene: {}: a {} (allowed: a number, text, a list, a table)", path,
                  Py_TYPE(value.ptr())->tp_name));
}

toml::array list_from(const py::handle& list, const std::string& path) {
  toml::array array;
  for (const py::handle& element : list) {
    place_value(element, path, [&array](auto&& value) { array.push_back(value); });
  }
  return array;
}

py::object python_value(const toml::node& node) {
  if (const toml::table* table = node.as_table()) return to_python(*table);
  if (const toml::array* array = node.as_array()) {
    py::list list;
    for (const toml::node& element : *array) list.append(python_value(element));
    return list;
  }
  if (const auto text = node.value_exact<std::string>()) return py::str(*text);
  if (const auto integer = node.value_exact<std::int64_t>()) return py::int_(*integer);
  if (const auto number = node.value_exact<double>()) return py::float_(*number);
  if (const auto truth = node.value_exact<bool>()) return py::bool_(*truth);
  return py::none();  // dates, which no key of a scene has
}

}  // namespace

toml::table to_toml(const py::dict& document, const std::string& path) {
  toml::table table;
  for (const auto& [key, value] : document) {
    if (value.is_none()) continue;
    const auto name = key.cast<std::string>();
    place_value(value, path.empty() ? name : fmt::format("{}.{}", path, name),
                [&](auto&& placed) { table.insert_or_assign(name, placed); });
  }
  return table;
}

py::dict to_python(const toml::table& table) {
  py::dict document;
  for (const auto& [key, value] : table) {
    document[py::str(std::string(key.str()))] = python_value(value);
  }
  return document;
}

}  // namespace dlo::python
