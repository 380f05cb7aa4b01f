#include "module.hpp"

#include <exception>
#include <stdexcept>

#include "dlo/compare/error.hpp"
#include "long_call.hpp"

namespace dlo::python {
namespace {

void set_error(const char* name, const py::tuple& arguments) {
  const py::object type = py::module_::import("dlo._errors").attr(name);
  const py::object value = type(*arguments);
  PyErr_SetObject(type.ptr(), value.ptr());
}

void translate_errors() {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the type is pybind11's
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const compare::InputError& error) {
      set_error("InputError", py::make_tuple(error.what(), error.key(), error.problem()));
    } catch (const compare::ConvergenceError& error) {
      set_error("ConvergenceError", py::make_tuple(error.what()));
    } catch (const std::invalid_argument& error) {
      set_error("InputError", py::make_tuple(error.what()));
    }
  });
}

}  // namespace

void raise_convergence(const std::string& message, const py::object& result) {
  set_error("ConvergenceError", py::make_tuple(message, result));
  throw py::error_already_set();
}

}  // namespace dlo::python

PYBIND11_MODULE(_dlo, module) {
  module.doc() = "What dlo computes, in C++; import dlo instead.";
  module.attr("__version__") = DLO_VERSION;
  dlo::python::stop_calls_at_exit(module);
  dlo::python::translate_errors();
  dlo::python::bind_scene(module);
  dlo::python::bind_result(module);
  dlo::python::bind_solve(module);
  dlo::python::bind_judge(module);
  dlo::python::bind_studies(module);
  dlo::python::bind_suite(module);
  dlo::python::bind_track(module);
  dlo::python::bind_force_model(module);
  dlo::python::bind_batch(module);
}
