#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "array.hpp"
#include "record/field.hpp"

namespace dlo::python {

namespace py = pybind11;

using NumberDict = Typed<py::dict, "dict[str, float]">;

/// Binds an array as an attribute: a view into the object, which it keeps alive.
/// @param of  returns a pointer to the numbers or points of an object of the class
template <typename Object, typename... Options, typename Of>
void bind_array(py::class_<Object, Options...>& bound, const char* name, const char* words,
                const Of& of) {
  bound.def_property_readonly(
      name,
      [of](const py::object& self) {
        const auto& values = *of(self.cast<const Object&>());
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(values)>, std::vector<double>>) {
          return values_view(values, self);
        } else {
          return rows_view(values.data(), values.cols(), self);
        }
      },
      words);
}

/// Binds the fields of a record that are in_python as attributes, except those of JSON.
/// @param of  returns the record of an object of the class
template <typename Object, typename... Options, typename T, typename Of>
void bind_fields(py::class_<Object, Options...>& bound, std::span<const compare::Field<T>> fields,
                 const Of& of) {
  for (const compare::Field<T>& field : fields) {
    if ((field.places & compare::in_python) == 0) continue;
    const auto bind = [&](auto get) {
      using Value = decltype(get(std::declval<const T&>()));
      if constexpr (!std::is_same_v<Value, compare::Json>) {
        const auto value = [get, of](const Object& object) {
          if constexpr (std::is_same_v<Value, compare::Numbers>) {
            NumberDict dict;
            for (const auto& [name, number] : get(of(object))) dict[py::str(name)] = number;
            return dict;
          } else {
            return get(of(object));
          }
        };
        bound.def_property_readonly(std::string(field.name).c_str(), value,
                                    field.python_words().c_str());
      }
    };
    std::visit(bind, field.get);
  }
}

}  // namespace dlo::python
