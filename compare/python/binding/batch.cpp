#include "dlo/force_model/batch.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>

#include "array.hpp"
#include "bind_scene.hpp"
#include "chain_rod.hpp"
#include "dlo/compare/error.hpp"
#include "long_call.hpp"
#include "module.hpp"
#include "parallel/threads.hpp"
#include "result.hpp"

namespace dlo::python {
namespace {

/// Batch of rods that threads of Python share; calls exclude each other.
class Batch : public MadeByItsClass {
 public:
  Batch(const std::vector<SharedScene>& scenes, int threads)
      : batch_(make_rods(scenes)), arena_(compare::arena_threads(threads)) {}

  [[nodiscard]] std::size_t size() const { return batch_.size(); }

  void step(long count) {
    const long between_looks =
        steps_between_looks(static_cast<long>(size()) * batch_.rod(0).points());
    run_long([&](Signals& signals) {
      const std::lock_guard lock(mutex_);
      while (count > 0 && !signals.stop()) {
        const long steps = std::min(count, between_looks);
        compare::execute(arena_, [&] {
          tbb::parallel_for(std::size_t{0}, batch_.blocks(),
                            [&](std::size_t block) { batch_.step_block(block, steps); });
        });
        count -= steps;
      }
      return true;
    });
  }

  void move_gripper(std::size_t rod, std::size_t gripper, const ArrayLike& position,
                    const OptionalArrayLike& direction) {
    require_rod(rod);
    const Eigen::Vector3d to = vector_from(position, "position");
    const std::optional<Eigen::Vector3d> along =
        direction.is_none() ? std::nullopt : std::optional(vector_from(direction, "direction"));
    const GilReleased released;
    const std::lock_guard lock(mutex_);
    batch_.move_grip(rod, gripper, moved_targets(batch_.rod(rod), gripper, to, along), to);
  }

  py::array_t<double> points(const OutputArray& out) {
    const auto rods = static_cast<py::ssize_t>(size());
    py::array_t<double> array = output_array(out, {rods, batch_.rod(0).points(), 3});
    double* to = array.mutable_data();
    {
      const GilReleased released;
      const std::lock_guard lock(mutex_);
      for (std::size_t rod = 0; rod < size(); ++rod) {
        const Eigen::Matrix3Xd positions = batch_.points(rod);
        to = std::copy_n(positions.data(), positions.size(), to);
      }
    }
    return array;
  }

  py::array_t<bool> diverged() {
    py::array_t<bool> array(static_cast<py::ssize_t>(size()));
    const GilReleased released;
    const std::lock_guard lock(mutex_);
    for (std::size_t rod = 0; rod < size(); ++rod) array.mutable_data()[rod] = batch_.diverged(rod);
    return array;
  }

 private:
  void require_rod(std::size_t rod) const {
    if (rod < size()) return;
    throw compare::InputError(
        fmt::format("rod = {}: there is none (allowed: 0 to {})", rod, size() - 1));
  }

  static force_model::Batch make_rods(const std::vector<SharedScene>& scenes) {
    return run_long([&](Signals& signals) {
      std::vector<force_model::BatchRod> rods;
      for (const SharedScene& scene : scenes) {
        rods.push_back(chain_rod(*scene, std::nullopt, std::nullopt).start);
        signals.throw_if_stopped();
      }
      return force_model::Batch(rods);
    });
  }

  force_model::Batch batch_;
  tbb::task_arena arena_;
  CallMutex mutex_;
};

}  // namespace

void bind_batch(py::module_& module) {
  py::class_<Batch> bound(module, "Batch");
  refuse_pickle(bound, "pickled or copied", "a new one of its scenes");
  bound
      .def(py::init([](const std::vector<SharedScene>& scenes, int threads) {
             // NOLINTNEXTLINE(modernize-make-unique): its own operator new is for Python's alone
             return std::unique_ptr<Batch>(::new Batch(scenes, threads));
           }),
           py::arg("scenes"), py::arg("threads"))
      .def("__len__", &Batch::size)
      .def("step", &Batch::step, py::arg("count") = 1,
           "Makes count steps of every rod. A rod that diverges stays where it was, see\n"
           "diverged.")
      .def("move_gripper", &Batch::move_gripper, py::arg("rod"), py::arg("gripper"),
           py::arg("position"), py::arg("direction") = py::none(),
           "Moves a gripper of one rod (number from 0), as ForceModel.move_gripper does.")
      .def("points", &Batch::points, py::arg("out") = py::none(),
           "Positions [m], shape (R, N, 3): written into out if it is given (float64, without\n"
           "gaps), else a new array.")
      .def_property_readonly("diverged", &Batch::diverged,
                             "Whether each rod has diverged: a new array of bool, shape (R,).");
}

}  // namespace dlo::python
