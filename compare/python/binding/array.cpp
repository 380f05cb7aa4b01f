#include "array.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "dlo/compare/error.hpp"

namespace dlo::python {
namespace {

constexpr auto number = static_cast<py::ssize_t>(sizeof(double));

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string shape_text(const py::array& array) {
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    text += fmt::format("{}{}", i == 0 ? "" : ", ", array.shape(i));
  }
  return fmt::format("({}{})", text, array.ndim() == 1 ? "," : "");
}

/// Largest number of elements that any function accepts, checked before an array is copied.
constexpr py::ssize_t most_numbers = 3'000'000;

/// Refuses the name of a file in place of an array. Functions that read files have accepted it
/// before.
void refuse_file_name(py::handle values, const std::string& name) {
  if (!py::isinstance<py::str>(values) && !py::hasattr(values, "__fspath__")) return;
  throw compare::InputError(fmt::format(
      "{0}: the name of a file (allowed: an array, such as numpy.loadtxt({1}, delimiter=\",\"))",
      name, py::repr(values).cast<std::string>()));
}

Numbers numbers_from(py::handle values, const std::string& name) {
  refuse_file_name(values, name);
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

py::array read_only(py::array view) {
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

}  // namespace

py::array rows_view(const double* first, py::ssize_t rows, py::handle owner, py::ssize_t stride) {
  return read_only(py::array(py::dtype::of<double>(), {rows, py::ssize_t{3}},
                             {stride * number, number}, rows == 0 ? nullptr : first,
                             rows == 0 ? py::handle() : owner));
}

py::array points_view(const Eigen::Matrix3Xd& points, py::handle owner) {
  return rows_view(points.data(), points.cols(), owner);
}

py::array values_view(const std::vector<double>& values, py::handle owner) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return read_only(py::array(py::dtype::of<double>(), {size}, {number},
                             values.empty() ? nullptr : values.data(),
                             values.empty() ? py::handle() : owner));
}

py::array vector_copy(const Eigen::Vector3d& vector) {
  return read_only(py::array(py::dtype::of<double>(), {py::ssize_t{3}}, {number}, vector.data()));
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
