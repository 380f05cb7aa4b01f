#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <type_traits>
#include <utility>

#include "array.hpp"
#include "bind_scene.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/plan.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/solve.hpp"
#include "fields.hpp"
#include "format/json.hpp"
#include "format/result_output.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "picture/figures.hpp"
#include "record/solution_fields.hpp"
#include "result.hpp"

namespace dlo::python {
namespace {

using compare::Solution;

template <typename Number>
Number positive(const std::string& name, py::handle value) {
  std::string problem = "out of range (allowed: > 0, up to 1e12)";
  try {
    const auto number = value.cast<Number>();
    if (number > 0 && static_cast<double>(number) <= 1e12) return number;
  } catch (const py::cast_error&) {
    if (PyLong_Check(value.ptr()) == 0) {
      problem = fmt::format("a {} (allowed: {})", Py_TYPE(value.ptr())->tp_name,
                            std::is_integral_v<Number> ? "an integer" : "a number");
    }
  }
  throw compare::InputError(
      fmt::format("{} = {}: {}", name, py::repr(value).cast<std::string>(), problem));
}

compare::Plan plan_of(const compare::Scene& scene, double time_limit) {
  compare::PlanOptions options;
  options.time_limit = std::min(options.time_limit, time_limit);
  return compare::make_plan(scene, options);
}

/// Solution or AllSolutions with the data that their documents need.
template <typename Found>
struct Solved : Result {
  Solved(SharedScene from, Found result, double limit)
      : scene(std::move(from)), found(std::move(result)), time_limit(limit) {}

  static constexpr bool is_one = std::is_same_v<Found, Solution>;
  [[nodiscard]] std::string text() const override {
    if constexpr (is_one) return cli::solution_text(found, scene->scene);
    if constexpr (!is_one) return cli::equilibria_text(found, scene->scene);
  }
  [[nodiscard]] std::string json() const override {
    return run_long([&](Signals& /*signals*/) {
      const compare::Plan plan = plan_of(scene->scene, time_limit);
      if constexpr (is_one) return cli::json_text(cli::solution_json(found, scene->scene, plan));
      if constexpr (!is_one) return cli::json_text(cli::equilibria_json(found, scene->scene, plan));
    });
  }
  [[nodiscard]] compare::Drawing drawing() const override {
    if constexpr (is_one) return compare::solution_drawing(scene->scene, {found});
    if constexpr (!is_one) return compare::solution_drawing(scene->scene, found.solutions);
  }

  SharedScene scene;
  Found found;
  double time_limit;  ///< limit of each solve [s]
};

using SolvedScene = Solved<Solution>;
using SolvedStates = Solved<compare::AllSolutions>;

/// Returns equal arc lengths; for 0 an empty list, so that the model chooses them.
std::vector<double> samples_of(const SharedScene& scene, int count) {
  return count > 0 ? compare::equal_arc_lengths(scene->scene.length, count) : std::vector<double>{};
}

/// Solves a scene. @param model_name  empty: the scene's reference_model()
/// @param number  number of an equilibrium in the list of solve_all(), from 1; empty: the
/// equilibrium of the model
/// @param near  None, or a pair: points, or as bytes the name of a file; and arc lengths, or None
std::shared_ptr<SolvedScene> solve(const SharedScene& scene, const std::string& model_name,
                                   int samples, const std::optional<int>& number,
                                   const py::object& near, const py::dict& limits) {
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
  Solution found = run_long([&](Signals& /*signals*/) {
    const std::vector<double> s = samples_of(scene, samples);
    if (number) {
      return cli::numbered_equilibrium(compare::solve_all(scene->scene, options, s), *number,
                                       scene->scene);
    }
    if (from) return compare::solve_near(scene->scene, *from, options, s);
    return compare::solve(scene->scene, model, options, s);
  });
  const auto solved = std::make_shared<SolvedScene>(scene, std::move(found), options.time_limit);
  if (!energy_model::succeeded(solved->found.status) &&
      !compare::is_balance_alone(scene->scene, solved->found)) {
    raise_convergence(fmt::format("{}: the {} model: {}", scene->scene.file,
                                  compare::to_string(model), solved->found.message),
                      py::cast(solved));
  }
  return solved;
}

/// @param make_result  function of a result, the solutions, and the omitted searches
py::object solve_all(const SharedScene& scene, int samples, const py::object& make_result,
                     const py::dict& limits) {
  const compare::SolveOptions options = solve_options(limits);
  compare::AllSolutions found = run_long([&](Signals& /*signals*/) {
    return compare::solve_all(scene->scene, options, samples_of(scene, samples));
  });
  const auto solved = std::make_shared<SolvedStates>(scene, std::move(found), options.time_limit);
  py::list solutions;
  for (const Solution& one : solved->found.solutions) {
    solutions.append(std::make_shared<SolvedScene>(scene, one, options.time_limit));
  }
  return make_result(AnyResult(solved), solutions, solved->found.omitted);
}

/// Binds a view of vectors, one for each of the solution's grippers or obstacles.
/// @param vector  returns a pointer to the vector of one of them
template <typename Class, typename Loads, typename Vector>
void bind_rows(Class& bound, const char* name, Loads Solution::*loads, const char* words,
               const Vector& vector) {
  bound.def_property_readonly(
      name,
      [loads, vector](const py::object& self) {
        const Loads& all = self.cast<const SolvedScene&>().found.*loads;
        constexpr py::ssize_t stride = sizeof(typename Loads::value_type) / sizeof(double);
        const double* first = all.empty() ? nullptr : vector(all.front())->data();
        return rows_view(first, static_cast<py::ssize_t>(all.size()), self, stride);
      },
      words);
}

template <typename Class>
void bind_arrays(Class& bound) {
  bind_array(bound, "arc_length", "Arc lengths of the points [m], shape (M,), read only.",
             [](const SolvedScene& s) { return &s.found.shape.arc_length; });
  bind_array(bound, "points", "Positions [m], shape (M, 3), read only.",
             [](const SolvedScene& s) { return &s.found.shape.points; });
  bind_array(bound, "curvature", "Curvature at the points [1/m], shape (M,), read only.",
             [](const SolvedScene& s) { return &s.found.curvature; });
  bind_array(bound, "tension",
             "Tension at the points, > 0 where the rod is pulled [N], shape (M,), or (0,) where\n"
             "the model has none or the rod touches an obstacle that yields; read only.",
             [](const SolvedScene& s) { return &s.found.tension; });
  bind_array(bound, "d1",
             "First directors of the rod's frame [-], shape (M, 3), or (0, 3) where the model has\n"
             "none; read only.",
             [](const SolvedScene& s) { return &s.found.d1; });
  bind_rows(bound, "gripper_forces", &Solution::grippers,
            "Force that each gripper exerts on the rod [N], shape (G, 3), read only.",
            [](const compare::GripperLoad& load) { return &load.force; });
  bind_rows(bound, "gripper_torques", &Solution::grippers,
            "Torque that each gripper exerts on the rod, about the gripper's position [N m],\n"
            "shape (G, 3), read only.",
            [](const compare::GripperLoad& load) { return &load.torque; });
  bind_rows(bound, "obstacle_forces", &Solution::obstacles,
            "Force that each obstacle exerts on the rod [N], shape (O, 3), read only.",
            [](const Eigen::Vector3d& force) { return &force; });
}

}  // namespace

compare::SolveOptions solve_options(const py::dict& given) {
  compare::SolveOptions options{.accept_unverified = true};
  for (const auto& [key, value] : given) {
    if (value.is_none()) continue;
    const auto name = key.cast<std::string>();
    const auto set = [&, &value = value](const char* own, auto& number) {
      if (name == own) number = positive<std::remove_cvref_t<decltype(number)>>(name, value);
      return name == own;
    };
    if (!set("time_limit", options.time_limit) && !set("terms", options.terms) &&
        !set("max_evaluations", options.max_evaluations) && !set("max_steps", options.max_steps) &&
        !set("rest_tolerance", options.rest_tolerance)) {
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
  py::class_<SolvedScene, Result, std::shared_ptr<SolvedScene>> solution(
      module, "Solution",
      "Equilibrium of a scene's rod and the cost of its computation; returned by solve() and,\n"
      "as an item of Equilibria, by solve_all().\n\n"
      "Arrays are views into it, read only; they keep it alive.");
  bind_arrays(solution);
  const auto of = [](const SolvedScene& solved) {
    return compare::SolvedShape{solved.scene->scene, solved.found};
  };
  bind_fields(solution, compare::solution_fields(), of);
  bind_fields(solution, compare::shape_numbers(), of);
  module.def("solve", &solve).def("solve_all", &solve_all);
  module.def("plan", [](const SharedScene& scene, double target, double speed, double time_limit) {
    return run_long([&](Signals& /*signals*/) {
      const compare::Plan plan = compare::make_plan(
          scene->scene, {.target = target, .gripper_speed = speed, .time_limit = time_limit});
      return AnyResult(std::make_shared<Texts>(cli::plan_text(plan, scene->scene),
                                               cli::json_text(cli::plan_json(plan))));
    });
  });
}

}  // namespace dlo::python
