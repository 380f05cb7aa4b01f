#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "array.hpp"
#include "bind_scene.hpp"
#include "chain_rod.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/force_model/simulation.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "result.hpp"

namespace dlo::python {
namespace {

/// Simulation that threads of Python share; calls exclude each other.
class ForceModel : public MadeByItsClass {
 public:
  ForceModel(SharedScene scene, const py::object& points, std::optional<double> grip_stiffness)
      : scene_(std::move(scene)),
        rod_(make_rod(*scene_, points, grip_stiffness)),
        simulation_(rod_.start.rod, rod_.start.points, rod_.start.options),
        positions_(rod_.start.points),
        forces_(3, positions_.cols()),
        reactions_(rod_.start.rod.grips.size()) {}

  [[nodiscard]] Eigen::Index size() const { return positions_.cols(); }

  void step(long count) {
    const long between_looks = steps_between_looks(size());
    bool diverged = false;
    {
      Signals signals;
      {
        const GilReleased released;
        const std::lock_guard lock(mutex_);
        while (count > 0 && !diverged) {
          const long block = std::min(count, between_looks);
          for (long i = 0; i < block && !diverged; ++i) {
            diverged = simulation_.step().status == force_model::StepStatus::diverged;
          }
          count -= block;
          if (count > 0 && signals.stop()) break;
        }
      }
      signals.rethrow();
    }
    if (diverged) {
      raise_convergence(fmt::format("{}: the force model diverged after {} steps",
                                    scene_->scene.file, simulation_.steps()),
                        py::none());
    }
  }

  std::pair<long, double> rest(double tolerance, long max_steps, double time_limit) {
    const force_model::RelaxResult result = run_long([&](Signals& /*signals*/) {
      const std::lock_guard lock(mutex_);
      return simulation_.relax({.tolerance = tolerance,
                                .max_steps = max_steps,
                                .time_limit = time_limit,
                                .interrupted = energy_model::interrupted});
    });
    if (result.status != force_model::RelaxStatus::at_rest) {
      raise_convergence(fmt::format("{}: the force model did not come to rest: {} after {} steps",
                                    scene_->scene.file, result.message, result.steps),
                        py::none());
    }
    return {result.steps, result.remaining_error};
  }

  void move_gripper(std::size_t gripper, const ArrayLike& position,
                    const OptionalArrayLike& direction) {
    const Eigen::Vector3d to = vector_from(position, "position");
    const std::optional<Eigen::Vector3d> along =
        direction.is_none() ? std::nullopt : std::optional(vector_from(direction, "direction"));
    const Lock lock(mutex_);
    simulation_.move_grip(gripper, moved_targets(simulation_.rod(), gripper, to, along), to);
  }

  void move_wall(std::size_t wall, const ArrayLike& point, const ArrayLike& normal) {
    const MovedWall moved =
        moved_wall(*scene_, rod_, wall, vector_from(point, "point"), vector_from(normal, "normal"));
    const Lock lock(mutex_);
    simulation_.move_wall(moved.index, moved.wall);
  }

  py::array_t<double> points(const OutputArray& out) {
    py::array_t<double> array = output_array(out, {size(), 3});
    const Lock lock(mutex_);
    simulation_.copy_points(positions_);
    std::copy_n(positions_.data(), positions_.size(), array.mutable_data());
    return array;
  }

  py::array_t<double> reactions(const OutputArray& out) {
    py::array_t<double> array = output_array(out, {static_cast<py::ssize_t>(reactions_.size()), 6});
    const Lock lock(mutex_);
    simulation_.copy_points(positions_);
    force_model::grip_reactions(simulation_.rod(), positions_, forces_, reactions_);
    double* to = array.mutable_data();
    for (const force_model::GripReaction& reaction : reactions_) {
      to = std::copy_n(reaction.force.data(), 3, to);
      to = std::copy_n(reaction.torque.data(), 3, to);
    }
    return array;
  }

  [[nodiscard]] long steps() {
    const Lock lock(mutex_);
    return simulation_.steps();
  }
  [[nodiscard]] std::pair<double, double> constants() {
    const Lock lock(mutex_);
    return {simulation_.options().c_F, simulation_.options().c_h};
  }
  [[nodiscard]] double energy() {
    const Lock lock(mutex_);
    simulation_.copy_points(positions_);
    return force_model::energy(simulation_.rod(), positions_).total();
  }
  [[nodiscard]] py::array arc_length(const py::object& self) const {
    return values_view(rod_.discretisation.arc_length, self);
  }

 private:
  /// Lock for a thread that holds the GIL. It releases the GIL while it waits, because the thread
  /// that uses the simulation may need it.
  class Lock {
   public:
    explicit Lock(CallMutex& mutex) : lock_(mutex, std::try_to_lock) {
      if (lock_.owns_lock()) return;
      GilReleased released;
      lock_.lock();
      // A thread that waits for the end of the process must not block others.
      if (!released.take_back()) lock_.unlock();
    }

   private:
    std::unique_lock<CallMutex> lock_;
  };

  static ChainRod make_rod(const SceneData& data, const py::object& points,
                           std::optional<double> grip_stiffness) {
    const auto start =
        points.is_none() ? std::nullopt : std::optional(points_from(points, "points"));
    return run_long([&](Signals& /*signals*/) { return chain_rod(data, start, grip_stiffness); });
  }

  SharedScene scene_;
  ChainRod rod_;
  CallMutex mutex_;
  force_model::Simulation simulation_;
  Eigen::Matrix3Xd positions_;
  Eigen::Matrix3Xd forces_;
  std::vector<force_model::GripReaction> reactions_;
};

}  // namespace

void bind_force_model(py::module_& module) {
  py::class_<ForceModel> bound(module, "ForceModel");
  refuse_pickle(bound, "pickled or copied", "a new one of its scene, with points=loop.points()");
  bound
      .def(py::init([](SharedScene scene, const OptionalArrayLike& points,
                       std::optional<double> grip_stiffness) {
             // NOLINTNEXTLINE(modernize-make-unique): its own operator new is for Python's alone
             return std::unique_ptr<ForceModel>(
                 ::new ForceModel(std::move(scene), points, grip_stiffness));
           }),
           py::arg("scene"), py::arg("points"), py::arg("grip_stiffness"))
      .def("__len__", &ForceModel::size)
      .def("step", &ForceModel::step, py::arg("count") = 1,
           "Makes count steps. Raises ConvergenceError if a step diverges; the points then stay\n"
           "where they were before that step.")
      .def("rest", &ForceModel::rest, py::arg("tolerance") = 1e-7,
           py::arg("max_steps") = 20'000'000, py::arg("time_limit") = 20.0,
           "Makes steps until the rod is at rest; returns (number of steps, bound of the RMS\n"
           "distance to rest [m]). Raises ConvergenceError if it does not come to rest.\n"
           "tolerance: largest bound at rest, divided by the rod's length.")
      .def("move_gripper", &ForceModel::move_gripper, py::arg("gripper"), py::arg("position"),
           py::arg("direction") = py::none(),
           "Moves a gripper (number in the scene, from 0) to a position [m], shape (3,), and\n"
           "rotates a clamp to a direction, a vector of any length, shape (3,); None keeps its\n"
           "direction.")
      .def("move_wall", &ForceModel::move_wall, py::arg("wall"), py::arg("point"),
           py::arg("normal"),
           "Moves a plane (number of the scene's obstacle, from 0): a point of it [m] and its\n"
           "normal to the free side, each of shape (3,).")
      .def("points", &ForceModel::points, py::arg("out") = py::none(),
           "Positions [m], shape (N, 3): written into out if it is given (float64, without\n"
           "gaps), else a new array.")
      .def("reactions", &ForceModel::reactions, py::arg("out") = py::none(),
           "Force [N] and torque about the gripper's position [N m] that each gripper exerts on\n"
           "the rod, shape (G, 6); the gripper feels the opposite. out: as in points().")
      .def("energy", &ForceModel::energy,
           "Energy of the current shape [J]; the potential of gravity and loads is zero at the\n"
           "origin.")
      .def_property_readonly("steps", &ForceModel::steps,
                             "Number of steps made since construction.")
      .def_property_readonly("constants", &ForceModel::constants,
                             "(c_F [m/N], c_h [-]) of the last step.")
      .def_property_readonly(
          "arc_length",
          [](const py::object& self) { return self.cast<const ForceModel&>().arc_length(self); },
          "Arc lengths of the points [m], shape (N,), read only; that of a point inside an end\n"
          "gripper is below 0 or above the rod's length.");
}

}  // namespace dlo::python
