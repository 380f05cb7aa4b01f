#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "figure/layout.hpp"
#include "figure/series.hpp"
#include "format/json.hpp"
#include "record/csv_table.hpp"

namespace dlo::python {

namespace py = pybind11;

/// Refuses pickling. Older protocols of pickle would make an object without its C++ object, whose
/// use ends the interpreter. @param what  the refused operation  @param instead  the allowed
/// alternative
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

/// Base of classes whose objects Python makes by calling the class. An object of
/// Class.__new__(Class) alone has no C++ object; pybind11 would allocate it and leave it
/// uninitialised at its first use. Bindings use ::new.
struct MadeByItsClass {
  static void* operator new(std::size_t /*size*/) {
    throw py::type_error("not made by its class (allowed: to call the class)");
  }
  static void operator delete(void* memory) { ::operator delete(memory); }
};

/// Refuses Class.__new__ for a class whose objects are made by functions only. An object without
/// its C++ object would end the interpreter when it is used.
/// @param maker  function that makes one
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

/// Result of a computation, from which Python's object is made. It never changes after its
/// construction.
struct Result {
  virtual ~Result() = default;

  /// Returns the text of the command.
  [[nodiscard]] virtual std::string text() const = 0;
  /// Returns the document of the command with `--format json`.
  [[nodiscard]] virtual std::string json() const = 0;
  /// Returns the picture of the command; empty for a result without a shape.
  [[nodiscard]] virtual compare::Drawing drawing() const { return {}; }
  /// Returns the part of the picture that Python draws.
  /// @param in_space  whether it is drawn in space; empty: unless it lies in a plane
  [[nodiscard]] virtual compare::Panel panel(std::optional<bool> in_space) const;
};

using AnyResult = std::shared_ptr<Result>;

/// Result whose text and JSON are known.
struct Texts : Result {
  Texts(std::string text, std::string json) : text_(std::move(text)), json_(std::move(json)) {}
  explicit Texts(const compare::Document& document)
      : Texts(document.text(), cli::json_text(document.json)) {}

  [[nodiscard]] std::string text() const override { return text_; }
  [[nodiscard]] std::string json() const override { return json_; }

 private:
  std::string text_, json_;
};

}  // namespace dlo::python
