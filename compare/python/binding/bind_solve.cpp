#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <utility>

#include "array.hpp"
#include "bind_scene.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solve.hpp"
#include "errors.hpp"
#include "fields.hpp"
#include "format/json.hpp"
#include "format/plan_output.hpp"
#include "format/solution_output.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "picture.hpp"
#include "picture/solution_figure.hpp"
#include "record/solution_fields.hpp"
#include "result.hpp"
#include "solve_options.hpp"

namespace dlo::python {
namespace {

using compare::Solution;

/// A solution, and what its document needs besides. Never changed once it is made.
struct SolvedScene {
  SharedScene scene;
  Solution solution;
  double time_limit = 0;  ///< of the solve [s]
};

struct SolvedStates {
  SharedScene scene;
  compare::AllSolutions all;
  double time_limit = 0;  ///< of each solve [s]
};

template <typename Number>
Number positive(const std::string& name, py::handle value) {
  const auto number = value.cast<double>();
  if (!(number > 0) || !(number <= 1e12)) {
    throw compare::InputError(
        fmt::format("{} = {:g}: out of range (allowed: > 0, up to 1e12)", name, number));
  }
  return value.cast<Number>();
}

compare::Plan plan_of(const compare::Scene& scene, double time_limit) {
  compare::PlanOptions options;
  options.time_limit = std::min(options.time_limit, time_limit);
  return compare::make_plan(scene, options);
}

std::string solution_document(const SolvedScene& solved) {
  return run_long([&](Signals& /*signals*/) {
    const compare::Scene& scene = solved.scene->scene;
    return cli::json_text(
        cli::solution_json(solved.solution, scene, plan_of(scene, solved.time_limit)));
  });
}

std::string states_document(const SolvedStates& solved) {
  return run_long([&](Signals& /*signals*/) {
    const compare::Scene& scene = solved.scene->scene;
    return cli::json_text(
        cli::equilibria_json(solved.all, scene, plan_of(scene, solved.time_limit)));
  });
}

/// @param model_name  empty: the scene's reference_model()
/// @param number  of an equilibrium in the list of solve_all(), from 1; none: that of the model
/// @param near  none, or points, a pair of points and arc lengths, or as bytes the name of a file
py::object solve(const SharedScene& scene, const std::string& model_name, int samples,
                 const std::optional<int>& number, const py::object& near, const py::dict& limits) {
  const compare::Model model = model_name.empty() ? compare::reference_model(scene->scene)
                                                  : compare::from_name<compare::Model>(model_name);
  const compare::SolveOptions options = solve_options(limits);
  std::optional<compare::MeasuredShape> from;
  if (number && (model != compare::Model::energy || !near.is_none())) {
    throw compare::InputError("equilibrium: only model energy without near searches for all");
  }
  if (!near.is_none()) {
    const auto [points, arc_length] = near.cast<std::pair<py::object, py::object>>();
    from = measured_shape(points, arc_length, "near");
    if (model != compare::Model::energy) {
      throw compare::InputError("near: only model energy starts from points");
    }
  }
  auto solved = std::make_shared<SolvedScene>();
  solved->scene = scene;
  solved->time_limit = options.time_limit;
  solved->solution = run_long([&](Signals& /*signals*/) {
    const std::vector<double> s = samples > 0
                                      ? compare::equal_arc_lengths(scene->scene.length, samples)
                                      : std::vector<double>{};
    if (number) {
      return cli::numbered_equilibrium(compare::solve_all(scene->scene, options, s), *number,
                                       scene->scene);
    }
    if (from) return compare::solve_near(scene->scene, *from, options, s);
    return compare::solve(scene->scene, model, options, s);
  });
  py::object result = py::cast(solved);
  if (!energy_model::succeeded(solved->solution.status) &&
      !compare::is_balance_alone(scene->scene, solved->solution)) {
    raise_convergence(fmt::format("{}: the {} model: {}", scene->scene.file,
                                  compare::to_string(model), solved->solution.message),
                      result);
  }
  return result;
}

std::shared_ptr<SolvedStates> solve_all(const SharedScene& scene, int samples,
                                        const py::dict& limits) {
  const compare::SolveOptions options = solve_options(limits);
  auto solved = std::make_shared<SolvedStates>();
  solved->scene = scene;
  solved->time_limit = options.time_limit;
  solved->all = run_long([&](Signals& /*signals*/) {
    const std::vector<double> s = samples > 0
                                      ? compare::equal_arc_lengths(scene->scene.length, samples)
                                      : std::vector<double>{};
    return compare::solve_all(scene->scene, options, s);
  });
  return solved;
}

/// A field of a GripperLoad of all grippers, without copies. @param get  of one
template <typename Get>
py::array gripper_rows(const py::object& self, const Get& get) {
  const auto& loads = self.cast<const SolvedScene&>().solution.grippers;
  constexpr py::ssize_t stride = sizeof(compare::GripperLoad) / sizeof(double);
  const double* first = loads.empty() ? nullptr : get(loads.front()).data();
  return rows_view(first, static_cast<py::ssize_t>(loads.size()), self, stride);
}

template <typename Class>
void bind_arrays(Class& bound) {
  using S = const SolvedScene&;
  bind_array(
      bound, "arc_length", [](S s) -> const auto& { return s.solution.shape.arc_length; },
      "Arc lengths of the points [m], shape (M,), read only.");
  bind_array(
      bound, "points", [](S s) -> const auto& { return s.solution.shape.points; },
      "Positions [m], shape (M, 3), read only.");
  bind_array(
      bound, "curvature", [](S s) -> const auto& { return s.solution.curvature; },
      "Curvature at the points [1/m], shape (M,), read only.");
  bind_array(
      bound, "tension", [](S s) -> const auto& { return s.solution.tension; },
      "Tension at the points, > 0 where the rod is pulled [N], shape (M,), or (0,) where\n"
      "the model has none; read only.");
  bind_array(
      bound, "d1", [](S s) -> const auto& { return s.solution.d1; },
      "First directors of the rod's frame [-], shape (M, 3), or (0, 3) where the model has\n"
      "none; read only.");
  bound
      .def_property_readonly(
          "gripper_forces",
          [](const py::object& self) {
            return gripper_rows(
                self, [](const auto& load) -> const auto& { return load.force; });
          },
          "What each gripper exerts on the rod [N], shape (G, 3), read only.")
      .def_property_readonly(
          "gripper_torques",
          [](const py::object& self) {
            return gripper_rows(
                self, [](const auto& load) -> const auto& { return load.torque; });
          },
          "The same about each gripper's position [N m], shape (G, 3), read only.")
      .def_property_readonly(
          "obstacle_forces",
          [](const py::object& self) {
            const auto& forces = self.cast<const SolvedScene&>().solution.obstacles;
            return rows_view(forces.empty() ? nullptr : forces.front().data(),
                             static_cast<py::ssize_t>(forces.size()), self);
          },
          "What each obstacle exerts on the rod [N], shape (O, 3), read only.");
}

void bind_equilibria(py::module_& module) {
  py::class_<SolvedStates, std::shared_ptr<SolvedStates>> equilibria(
      module, "Equilibria",
      "Every equilibrium that was found: a sequence of Solution, stable ones first, by energy.");
  bind_result(equilibria);
  bind_picture(equilibria, [](const SolvedStates& solved) {
    return compare::solution_drawing(solved.scene->scene, solved.all.solutions);
  });
  equilibria.def("__len__", [](const SolvedStates& solved) { return solved.all.solutions.size(); })
      .def(
          "__getitem__",
          [](const SolvedStates& solved, py::ssize_t index) {
            const auto size = static_cast<py::ssize_t>(solved.all.solutions.size());
            if (index < 0) index += size;
            if (index < 0 || index >= size) throw py::index_error("no such equilibrium");
            return std::make_shared<SolvedScene>(
                SolvedScene{solved.scene, solved.all.solutions[static_cast<std::size_t>(index)],
                            solved.time_limit});
          },
          py::arg("index"))
      .def("__iter__",
           [](const py::object& self) {
             return py::reinterpret_steal<py::iterator>(PySeqIter_New(self.ptr()));
           })
      .def_property_readonly(
          "not_looked", [](const SolvedStates& solved) { return solved.all.not_looked; },
          "What a limit has cut short, or the search does not cover.")
      .def("to_json", &states_document, "The document of `dlo solve --all --format json`, as text.")
      .def("__str__", [](const SolvedStates& solved) {
        return cli::equilibria_text(solved.all, solved.scene->scene);
      });
}

}  // namespace

compare::SolveOptions solve_options(const py::dict& given) {
  compare::SolveOptions options{.accept_unverified = true};
  for (const auto& [key, value] : given) {
    if (value.is_none()) continue;
    const auto name = key.cast<std::string>();
    if (name == "time_limit") {
      options.time_limit = positive<double>(name, value);
    } else if (name == "rest_tolerance") {
      options.rest_tolerance = positive<double>(name, value);
    } else if (name == "max_steps") {
      options.max_steps = positive<long>(name, value);
    } else if (name == "max_evaluations") {
      options.max_evaluations = positive<int>(name, value);
    } else if (name == "terms") {
      options.terms = positive<int>(name, value);
    } else {
      throw compare::InputError(name +
                                ": no such limit (allowed: time_limit, terms, "
                                "max_evaluations, max_steps, rest_tolerance)");
    }
  }
  return options;
}

compare::SolveOptions verified_options(const py::dict& given) {
  compare::SolveOptions options = solve_options(given);
  options.accept_unverified = false;
  return options;
}

void bind_solve(py::module_& module) {
  py::class_<SolvedScene, std::shared_ptr<SolvedScene>> solution(
      module, "Solution",
      "A shape of a scene's rod in balance, and what it cost; of solve() and solve_all().\n\n"
      "Arrays are views into it, read only; they keep it alive.");
  bind_arrays(solution);
  bind_result(solution);
  bind_picture(solution, [](const SolvedScene& solved) {
    return compare::solution_drawing(solved.scene->scene, {solved.solution});
  });
  const auto of = [](const SolvedScene& solved) {
    return compare::SolvedShape{solved.scene->scene, solved.solution};
  };
  bind_fields(solution, compare::solution_fields(), of);
  bind_fields(solution, compare::shape_numbers(), of);
  solution.def("to_json", &solution_document, "The document of `dlo solve --format json`, as text.")
      .def("__str__", [](const SolvedScene& solved) {
        return cli::solution_text(solved.solution, solved.scene->scene);
      });
  bind_equilibria(module);
  module.def("solve", &solve, py::arg("scene"), py::arg("model"), py::arg("samples"),
             py::arg("number"), py::arg("near"), py::arg("limits"));
  module.def("solve_all", &solve_all, py::arg("scene"), py::arg("samples"), py::arg("limits"));
  module.def(
      "plan",
      [](const SharedScene& scene, double target, double speed, double time_limit) {
        return run_long([&](Signals& /*signals*/) {
          const compare::Plan plan = compare::make_plan(
              scene->scene, {.target = target, .gripper_speed = speed, .time_limit = time_limit});
          return std::pair(cli::plan_text(plan, scene->scene),
                           cli::json_text(cli::plan_json(plan)));
        });
      },
      py::arg("scene"), py::arg("target"), py::arg("gripper_speed"), py::arg("time_limit"));
}

}  // namespace dlo::python
