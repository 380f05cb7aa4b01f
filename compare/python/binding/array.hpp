#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dlo::python {

namespace py = pybind11;

/// View of M rows of 3 numbers that `owner` keeps alive, read only. @param stride  of rows, in
/// numbers
[[nodiscard]] py::array rows_view(const double* first, py::ssize_t rows, py::handle owner,
                                  py::ssize_t stride = 3);

/// M x 3 view of a 3 x M matrix, read only.
[[nodiscard]] py::array points_view(const Eigen::Matrix3Xd& points, py::handle owner);

/// The same of a row of numbers.
[[nodiscard]] py::array values_view(const std::vector<double>& values, py::handle owner);

/// A vector of three numbers, a copy.
[[nodiscard]] py::array vector_copy(const Eigen::Vector3d& vector);

/// Points from anything that NumPy makes an array of M x 3 or M x 2 numbers of (z is then 0).
/// @throws compare::InputError that says `name` otherwise
[[nodiscard]] Eigen::Matrix3Xd points_from(py::handle values, const std::string& name);

/// Numbers from anything that NumPy makes an array of M numbers of. @throws compare::InputError
[[nodiscard]] std::vector<double> values_from(py::handle values, const std::string& name);

/// Three numbers. @throws compare::InputError
[[nodiscard]] Eigen::Vector3d vector_from(py::handle values, const std::string& name);

/// Where to write: the user's array, which has to be writable, of float64, without gaps and of this
/// shape, or a new one for None. @throws compare::InputError
[[nodiscard]] py::array_t<double> output_array(const py::object& out,
                                               const std::vector<py::ssize_t>& shape);

}  // namespace dlo::python
