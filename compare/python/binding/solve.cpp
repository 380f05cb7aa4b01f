#include "dlo/compare/solve.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "array.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "errors.hpp"
#include "format/json.hpp"
#include "format/plan.hpp"
#include "format/solution.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "picture.hpp"
#include "picture/solution_figure.hpp"
#include "result.hpp"
#include "scene.hpp"
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

py::object solve(const SharedScene& scene, const std::string& model_name, int samples,
                 const py::dict& limits) {
  const auto model = compare::from_name<compare::Model>(model_name);
  const compare::SolveOptions options = solve_options(limits);
  auto solved = std::make_shared<SolvedScene>();
  solved->scene = scene;
  solved->time_limit = options.time_limit;
  solved->solution = run_long([&](Signals& /*signals*/) {
    const std::vector<double> s = samples > 0
                                      ? compare::equal_arc_lengths(scene->scene.length, samples)
                                      : std::vector<double>{};
    return compare::solve(scene->scene, model, options, s);
  });
  py::object result = py::cast(solved);
  if (!energy_model::succeeded(solved->solution.status)) {
    raise_convergence(fmt::format("{}: the {} model: {}", scene->scene.file, model_name,
                                  solved->solution.message),
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

py::dict energies(const compare::SceneEnergies& energy) {
  using namespace py::literals;  // NOLINT(google-build-using-namespace): of names alone
  return py::dict("bending"_a = energy.bending, "twisting"_a = energy.twisting,
                  "gravity"_a = energy.gravity, "load"_a = energy.load,
                  "stretch"_a = energy.stretch, "contact"_a = energy.contact,
                  "total"_a = energy.total());
}

Eigen::Matrix3Xd all_points(const SolvedStates& solved) {
  std::vector<Eigen::Vector3d> points;
  for (const Solution& solution : solved.all.solutions) {
    for (const auto& point : solution.shape.points.colwise()) points.emplace_back(point);
  }
  if (points.empty()) points.emplace_back(Eigen::Vector3d::Zero());
  return Eigen::Map<const Eigen::Matrix3Xd>(points.front().data(), 3,
                                            static_cast<Eigen::Index>(points.size()));
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
void bind_arrays(Class& solution) {
  const auto of = [](const py::object& self) -> const Solution& {
    return self.cast<const SolvedScene&>().solution;
  };
  solution
      .def_property_readonly(
          "arc_length",
          [of](const py::object& self) { return values_view(of(self).shape.arc_length, self); },
          "Arc lengths of the points [m], shape (M,), read only.")
      .def_property_readonly(
          "points",
          [of](const py::object& self) { return points_view(of(self).shape.points, self); },
          "Positions [m], shape (M, 3), read only.")
      .def_property_readonly(
          "curvature",
          [of](const py::object& self) { return values_view(of(self).curvature, self); },
          "Curvature at the points [1/m], shape (M,), read only.")
      .def_property_readonly(
          "tension", [of](const py::object& self) { return values_view(of(self).tension, self); },
          "Tension at the points, > 0 where the rod is pulled [N], shape (M,), or (0,) where\n"
          "the model has none; read only.")
      .def_property_readonly(
          "d1", [of](const py::object& self) { return points_view(of(self).d1, self); },
          "First directors of the rod's frame [-], shape (M, 3), or (0, 3) where the model has\n"
          "none; read only.")
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
          [of](const py::object& self) {
            const auto& forces = of(self).obstacles;
            return rows_view(forces.empty() ? nullptr : forces.front().data(),
                             static_cast<py::ssize_t>(forces.size()), self);
          },
          "What each obstacle exerts on the rod [N], shape (O, 3), read only.");
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

void bind_solve(py::module_& module) {
  const auto of = [](auto get) {
    return [get](const SolvedScene& solved) { return get(solved.solution); };
  };
  py::class_<SolvedScene, std::shared_ptr<SolvedScene>> solution(
      module, "Solution",
      "A shape of a scene's rod in balance, and what it cost; of solve() and solve_all().\n\n"
      "Arrays are views into it, read only; they keep it alive.");
  bind_arrays(solution);
  bind_result(solution);
  bind_picture(solution, [](const SolvedScene& solved) {
    return compare::views_of(solved.scene->scene, solved.solution.shape.points);
  });
  solution
      .def_property_readonly(
          "scene", [](const SolvedScene& s) { return s.scene->scene.name; }, "The scene's name.")
      .def_property_readonly("model",
                             of([](const Solution& s) { return compare::to_string(s.model); }),
                             "\"energy\", \"chain\", \"exact\" or \"force\".")
      .def_property_readonly("status",
                             of([](const Solution& s) { return cli::status_name(s.status); }),
                             "\"converged\", \"roundoff_limited\", \"saddle\", \"near_singular\" "
                             "or\n\"not_verified\".")
      .def_property_readonly(
          "converged", of([](const Solution& s) { return energy_model::succeeded(s.status); }),
          "Whether it is an equilibrium, proven stable.")
      .def_property_readonly("_unstable", of(compare::is_unstable))
      .def_property_readonly("message", of([](const Solution& s) { return s.message; }),
                             "How the solver ended.")
      .def_property_readonly("energy", of([](const Solution& s) { return energies(s.energy); }),
                             "Energies [J]: bending, twisting, gravity, load, stretch, contact, "
                             "total.")
      .def_property_readonly(
          "smallest_eigenvalue", of([](const Solution& s) { return s.smallest_eigenvalue; }),
          "Smallest eigenvalue of the reduced Hessian over EI/l, < 0 if unstable; NaN where no\n"
          "search looked.")
      .def_property_readonly("smallest_curvature",
                             of([](const Solution& s) { return s.smallest_eigenvalue; }),
                             "smallest_eigenvalue by its name before 0.2, which takes it away.")
      .def_property_readonly("error_estimate",
                             of([](const Solution& s) { return s.error_estimate; }),
                             "What the points may be off [m]; NaN: not known.")
      .def_property_readonly("evaluations", of([](const Solution& s) { return s.evaluations; }),
                             "Of the minimiser, or shots of exact.")
      .def_property_readonly("steps", of([](const Solution& s) { return s.steps; }),
                             "Of the force model.")
      .def_property_readonly("terms", of([](const Solution& s) { return s.terms; }),
                             "Curvature coefficients of the energy model.")
      .def_property_readonly("seconds", of([](const Solution& s) { return s.seconds; }),
                             "Wall time of the solver [s].")
      .def_property_readonly("neglected", of([](const Solution& s) { return s.neglected; }),
                             "What the scene has and the model neglects.")
      .def_property_readonly("left_out", of([](const Solution& s) { return s.neglected; }),
                             "neglected by its name before 0.2, which takes it away.")
      .def("to_json", &solution_document, "The document of `dlo solve --format json`, as text.")
      .def("__str__", [](const SolvedScene& solved) {
        return cli::solution_text(solved.solution, solved.scene->scene);
      });
  py::class_<SolvedStates, std::shared_ptr<SolvedStates>> equilibria(
      module, "Equilibria",
      "Every equilibrium that was found: a sequence of Solution, stable ones first, by energy.");
  bind_result(equilibria);
  bind_picture(equilibria, [](const SolvedStates& solved) {
    return compare::views_of(solved.scene->scene, all_points(solved));
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
  module.def("solve", &solve, py::arg("scene"), py::arg("model"), py::arg("samples"),
             py::arg("limits"));
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
