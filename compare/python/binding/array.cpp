#include "array.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/error.hpp"

namespace dlo::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string shape_text(const py::array& array) {
  return py::str(array.attr("shape")).cast<std::string>();
}

/// Largest number of elements that any function accepts, checked before an array is copied.
constexpr py::ssize_t most_numbers = 3'000'000;

Numbers numbers_from(py::handle values, const std::string& name) {
  // Functions that read files accepted the name of a file in earlier versions.
  if (py::isinstance<py::str>(values) || py::hasattr(values, "__fspath__")) {
    throw compare::InputError(fmt::format(
        "{0}: the name of a file (allowed: an array, such as numpy.loadtxt({1}, delimiter=\",\"))",
        name, py::repr(values).cast<std::string>()));
  }
  if (py::isinstance<py::array>(values)) {
    const py::ssize_t size = py::reinterpret_borrow<py::array>(values).size();
    if (size > most_numbers) {
      throw compare::InputError(
          fmt::format("{}: {} numbers (allowed: up to {})", name, size, most_numbers));
    }
  }
  Numbers array = Numbers::ensure(values);
  if (!array) {
    PyErr_Clear();
    throw compare::InputError(fmt::format("{}: no array of numbers", name));
  }
  return array;
}

/// Returns a read-only array of numbers at these strides [numbers]; without an owner a copy.
py::array numbers_view(const double* first, const std::vector<py::ssize_t>& shape,
                       std::vector<py::ssize_t> strides, py::handle owner) {
  for (py::ssize_t& stride : strides) stride *= static_cast<py::ssize_t>(sizeof(double));
  const bool empty = shape.front() == 0;
  py::array view(py::dtype::of<double>(), shape, strides, empty ? nullptr : first,
                 empty ? py::handle() : owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

}  // namespace

py::array rows_view(const double* first, py::ssize_t rows, py::handle owner, py::ssize_t stride) {
  return numbers_view(first, {rows, 3}, {stride, 1}, owner);
}

py::array values_view(const std::vector<double>& values, py::handle owner) {
  return numbers_view(values.data(), {static_cast<py::ssize_t>(values.size())}, {1}, owner);
}

py::array vector_copy(const Eigen::Vector3d& vector) {
  return numbers_view(vector.data(), {3}, {1}, {});
}

Eigen::Matrix3Xd points_from(py::handle values, const std::string& name) {
  const Numbers array = numbers_from(values, name);
  if (array.ndim() != 2 || (array.shape(1) != 3 && array.shape(1) != 2)) {
    throw compare::InputError(
        fmt::format("{}: an array of shape {} (allowed: (M, 3), or (M, 2) "
                    "with z = 0)",
                    name, shape_text(array)));
  }
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, array.shape(0));
  points.topRows(array.shape(1)) =
      Eigen::Map<const Eigen::MatrixXd>(array.data(), array.shape(1), array.shape(0));
  return points;
}

std::vector<double> values_from(py::handle values, const std::string& name) {
  const Numbers array = numbers_from(values, name);
  if (array.ndim() != 1) {
    throw compare::InputError(
        fmt::format("{}: an array of shape {} (allowed: (M,))", name, shape_text(array)));
  }
  return {array.data(), array.data() + array.size()};
}

Eigen::Vector3d vector_from(py::handle values, const std::string& name) {
  const Numbers array = numbers_from(values, name);
  if (array.ndim() != 1 || array.size() != 3) {
    throw compare::InputError(
        fmt::format("{}: an array of shape {} (allowed: (3,))", name, shape_text(array)));
  }
  return Eigen::Map<const Eigen::Vector3d>(array.data());
}

py::array_t<double> output_array(const py::object& out, const std::vector<py::ssize_t>& shape) {
  if (out.is_none()) return py::array_t<double>(shape);
  if (!py::array_t<double, py::array::c_style>::check_(out)) {
    throw compare::InputError("out: no array of float64 without gaps (allowed: numpy.empty(...))");
  }
  auto array = py::reinterpret_borrow<py::array_t<double>>(out);
  const bool fits = array.ndim() == static_cast<py::ssize_t>(shape.size()) &&
                    std::equal(shape.begin(), shape.end(), array.shape());
  if (!fits || !array.writeable()) {
    throw compare::InputError(fmt::format(
        "out: {}an array of shape {} (allowed: a writable one "
        "of ({}))",
        array.writeable() ? "" : "read only, ", shape_text(array), fmt::join(shape, ", ")));
  }
  return array;
}

}  // namespace dlo::python
