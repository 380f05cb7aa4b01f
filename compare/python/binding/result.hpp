#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "figure/layout.hpp"
#include "figure/series.hpp"

namespace dlo::python {

namespace py = pybind11;

/// Pickle's older ways would make an object without the C++ object in it, which ends the
/// interpreter. @param what  cannot be done with it  @param instead  what is allowed
template <typename Class>
void refuse_pickle(Class& bound, const char* what, const char* instead) {
  const auto refuse = [what, instead](const py::object& self,
                                      const py::args& /*protocol*/) -> py::object {
    throw py::type_error("a dlo." +
                         py::str(py::type::of(self).attr("__name__")).cast<std::string>() +
                         " cannot be " + what + " (allowed: " + instead + ")");
  };
  bound.def("__reduce_ex__", refuse).def("__reduce__", refuse);
}

/// A base of what Python makes by calling its class: an object of Class.__new__(Class) alone has no
/// C++ object, for which pybind11 would take memory and leave it as it is when it is first used.
/// Whoever makes one says ::new.
struct MadeByItsClass {
  static void* operator new(std::size_t /*size*/) {
    throw py::type_error("not made by its class (allowed: to call the class)");
  }
  static void operator delete(void* memory) { ::operator delete(memory); }
};

/// Of a class whose objects only functions make: an object without the C++ object in it, which
/// Class.__new__(Class) would be, ends the interpreter when it is used.
/// @param maker  what makes one
template <typename Class>
void refuse_new(Class& bound, const char* maker) {
  const py::cpp_function refuse(
      [maker](const py::args& /*all*/, const py::kwargs& /*all*/) -> py::object {
        throw py::type_error(std::string("not made by its class (allowed: ") + maker + ")");
      },
      py::name("__new__"));
  bound.attr("__new__") =
      py::reinterpret_steal<py::object>(PyStaticMethod_New(py::object(refuse).ptr()));
}

/// What _plot.py draws of a panel.
[[nodiscard]] py::dict panel_dict(const compare::Panel& described);

/// A result with a shape. Never changed once it is made.
struct Result {
  virtual ~Result() = default;

  /// Returns the text of the command.
  [[nodiscard]] virtual std::string text() const = 0;
  /// Returns the document of the command with `--format json`.
  [[nodiscard]] virtual std::string json() const = 0;
  /// Returns the picture of the command.
  [[nodiscard]] virtual compare::Drawing drawing() const = 0;
};

}  // namespace dlo::python
