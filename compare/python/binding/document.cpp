#include "document.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "base/text.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::python {
namespace {

using compare::InputError;

/// Depth of a value and number of values so far. Both are limited, because lists that contain
/// themselves, or each other many times, would not end.
struct Place {
  static constexpr long most_values = 1'000'000;

  std::string path;  ///< path in messages
  int depth;
  long& values;

  [[nodiscard]] Place within(const std::string& key) const { return {key, depth + 1, values}; }
  [[nodiscard]] Place within() const { return within(path); }
};

void require_within_limits(const Place& place) {
  if (place.depth > compare::deepest_nesting) {
    throw InputError(fmt::format("scene: {}: nested too deep (allowed: {} levels)", place.path,
                                 compare::deepest_nesting));
  }
  if (++place.values > Place::most_values) {
    throw InputError(fmt::format("scene: {}: too many values (allowed: {} in a scene)", place.path,
                                 Place::most_values));
  }
}

/// Returns a Python text in UTF-8.
/// @param path  field of the scene, for the message
/// @throws InputError if the text contains an unpaired surrogate
std::string text_from(const py::handle& text, const std::string& path) {
  Py_ssize_t size = 0;
  const char* data = PyUnicode_AsUTF8AndSize(text.ptr(), &size);
  if (data != nullptr) return {data, static_cast<std::size_t>(size)};
  PyErr_Clear();
  throw InputError(
      fmt::format("scene: {}: text with an unpaired surrogate (allowed: Unicode)", path));
}

std::int64_t integer_from(const py::handle& number, const std::string& path) {
  const auto integer = py::reinterpret_steal<py::object>(PyNumber_Index(number.ptr()));
  if (!integer) throw py::error_already_set();
  int beyond = 0;
  const std::int64_t value = PyLong_AsLongLongAndOverflow(integer.ptr(), &beyond);
  if (beyond == 0) return value;
  throw InputError(
      fmt::format("scene: {}: an integer out of range (allowed: up to 64 bits)", path));
}

toml::table table_from(const py::dict& document, const Place& place);
toml::array list_from(const py::handle& list, const Place& place);

/// Passes a converted value to `put(value)`.
template <typename Put>
void pass_value(const py::handle& value, const Place& place, const Put& put) {
  require_within_limits(place);
  if (py::isinstance<py::bool_>(value)) return put(value.cast<bool>());
  if (py::isinstance<py::str>(value)) return put(text_from(value, place.path));
  if (py::isinstance<py::dict>(value)) {
    return put(table_from(py::reinterpret_borrow<py::dict>(value), place));
  }
  if (py::isinstance<py::float_>(value)) return put(value.cast<double>());
  const bool is_array = py::hasattr(value, "tolist");  // arrays and scalars of NumPy
  if (is_array) return pass_value(value.attr("tolist")(), place.within(), put);
  if (PyIndex_Check(value.ptr()) != 0) return put(integer_from(value, place.path));
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    return put(list_from(value, place));
  }
  throw InputError(fmt::format("scene: {}: a {} (allowed: a number, text, a list, a table)",
                               place.path, Py_TYPE(value.ptr())->tp_name));
}

toml::array list_from(const py::handle& list, const Place& place) {
  toml::array array;
  for (const py::handle& element : list) {
    pass_value(element, place.within(),
               [&array](auto&& value) { array.push_back(std::forward<decltype(value)>(value)); });
  }
  return array;
}

toml::table table_from(const py::dict& document, const Place& place) {
  toml::table table;
  // The loop uses a copy, so that a value's tolist() cannot change the dict during iteration.
  const auto items = py::reinterpret_steal<py::dict>(PyDict_Copy(document.ptr()));
  if (!items) throw py::error_already_set();
  for (const auto& [key, value] : items) {
    if (value.is_none()) continue;
    if (!py::isinstance<py::str>(key)) {
      throw InputError(fmt::format("scene: {}: a key that is a {} (allowed: text)", place.path,
                                   Py_TYPE(key.ptr())->tp_name));
    }
    const std::string name = text_from(key, place.path);
    const std::string path = place.path.empty() ? name : fmt::format("{}.{}", place.path, name);
    pass_value(value, place.within(path), [&](auto&& placed) {
      table.insert_or_assign(name, std::forward<decltype(placed)>(placed));
    });
  }
  return table;
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
  long values = 0;
  return table_from(document, {path, 0, values});
}

py::dict to_python(const toml::table& table) {
  py::dict document;
  for (const auto& [key, value] : table) {
    document[py::str(std::string(key.str()))] = python_value(value);
  }
  return document;
}

}  // namespace dlo::python
