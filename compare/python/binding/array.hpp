#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace dlo::python {

namespace py = pybind11;

/// Name of a type, as a template argument.
template <std::size_t Size>
struct TypeName {
  // NOLINTNEXTLINE(google-explicit-constructor): a template argument is converted implicitly
  consteval TypeName(const char (&name)[Size]) { std::copy_n(name, Size, text); }
  char text[Size] = {};
};

/// Python object whose type the stub names more precisely than pybind11 does.
template <typename Object, TypeName name>
struct Typed : Object {
  using Object::Object;
  [[nodiscard]] static bool check_(py::handle handle) { return py::isinstance<Object>(handle); }
};

/// Anything that points_from(), values_from() or vector_from() converts.
using ArrayLike = Typed<py::object, "ArrayLike">;
using OptionalArrayLike = Typed<py::object, "Optional[ArrayLike]">;
/// Array that output_array() accepts.
using OutputArray = Typed<py::object, "Optional[numpy.ndarray]">;

/// Returns a read-only view of M rows of 3 numbers, which keeps `owner` alive.
/// @param stride  distance of rows, in numbers
[[nodiscard]] py::array rows_view(const double* first, py::ssize_t rows, py::handle owner,
                                  py::ssize_t stride = 3);

/// Returns a read-only view of a list of numbers, which keeps `owner` alive.
[[nodiscard]] py::array values_view(const std::vector<double>& values, py::handle owner);

/// Returns a copy of a vector of three numbers.
[[nodiscard]] py::array vector_copy(const Eigen::Vector3d& vector);

/// Reads points from anything that NumPy converts to an array of M x 3 or M x 2 numbers (z is then
/// 0).
/// @throws compare::InputError naming `name` otherwise
[[nodiscard]] Eigen::Matrix3Xd points_from(py::handle values, const std::string& name);

/// Reads numbers from anything that NumPy converts to an array of M numbers. @throws
/// compare::InputError
[[nodiscard]] std::vector<double> values_from(py::handle values, const std::string& name);

/// Reads three numbers. @throws compare::InputError
[[nodiscard]] Eigen::Vector3d vector_from(py::handle values, const std::string& name);

/// Returns the array to write to: the user's array, which must be writable, contiguous, of float64
/// and of this shape, or a new one for None. @throws compare::InputError
[[nodiscard]] py::array_t<double> output_array(const py::object& out,
                                               const std::vector<py::ssize_t>& shape);

}  // namespace dlo::python

template <typename Object, dlo::python::TypeName type_name>
struct pybind11::detail::handle_type_name<dlo::python::Typed<Object, type_name>> {
  static constexpr auto name = const_name(type_name.text);
};
