#include "module.hpp"

#include "long_call.hpp"

PYBIND11_MODULE(_dlo, module) {
  module.doc() = "What dlo computes, in C++; import dlo instead.";
  module.attr("__version__") = DLO_VERSION;
  pybind11::options options;
  options.disable_function_signatures();
  dlo::python::stop_calls_at_exit(module);
  dlo::python::bind_errors(module);
  dlo::python::bind_scene(module);
  dlo::python::bind_result(module);
  dlo::python::bind_solve(module);
  dlo::python::bind_judge(module);
  dlo::python::bind_studies(module);
  dlo::python::bind_regress(module);
  dlo::python::bind_suite(module);
  dlo::python::bind_track(module);
  dlo::python::bind_force_model(module);
  dlo::python::bind_batch(module);
}
