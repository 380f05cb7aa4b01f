#include "report/shape_grid.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "dlo/compare/error.hpp"
#include "study/benchmark.hpp"

namespace dlo::compare {
namespace {

constexpr int rod_samples = 33;
// Implicit steps to rest are seldom more than thirty: who needs more than this does not get there.
constexpr long most_model_steps = 5000;
constexpr int most_evaluations = 2000;  // an energy model's solve takes some ten

/// In the clamp's plane, the clamp at the origin.
Eigen::Matrix2Xd over_length(const Eigen::Matrix3Xd& points, double length) {
  return points.topRows<2>() / length;
}

GridCell compare_at(const Scene& scene) {
  SolveOptions limits;
  limits.max_steps = most_model_steps;
  limits.max_evaluations = most_evaluations;
  GridCell cell;
  try {
    const Comparison c = compare(scene, limits, std::nullopt, ModulusSearch::no);
    cell.rod = over_length(c.reference_rod(equal_arc_lengths(scene.length, rod_samples)).points,
                           scene.length);
    cell.polygon = over_length(c.force.shape.points, scene.length);
    const Eigen::Matrix3Xd apart = c.force.shape.points - c.reference.points;
    for (Eigen::Index i = 0; i < apart.cols(); ++i) {
      cell.s.push_back(c.force.shape.arc_length[static_cast<std::size_t>(i)] / scene.length);
      cell.distance.push_back(apart.col(i).norm() / scene.length);
    }
    cell.rms_over_length = c.deviation.rms_over_length;
    cell.max_over_length = c.deviation.max_m / scene.length;
    cell.max_at = c.deviation.max_at_m / scene.length;
  } catch (const ResultError& error) {
    cell.failure = error.what();
  }
  return cell;
}

}  // namespace

Scene grid_scene(double gamma, double angle_deg, int points, const GridModel& model) {
  Scene scene = benchmark_scenes().front();
  scene.scale_modulus(scene.gamma() / gamma);
  const double angle = angle_deg * std::numbers::pi / 180;
  scene.grippers.front().direction = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  scene.force_model = {.points = points,
                       .law = model.law,
                       .bookkeeping = model.bookkeeping,
                       .stepper = Stepper::implicit};
  return scene;
}

ShapeGrid make_shape_grid(const ShapeGridOptions& options, const Progress& progress) {
  if (options.gammas.empty() || options.angles_deg.empty() || options.points.empty()) {
    throw std::invalid_argument("make_shape_grid: a list is empty, must have one or more values");
  }
  ShapeGrid grid{.options = options,
                 .models = {{BendingLaw::paper, Bookkeeping::paper},
                            {BendingLaw::hooke, Bookkeeping::consistent}}};
  std::vector<Scene> scenes;
  scenes.reserve(options.gammas.size() * options.angles_deg.size() * options.points.size() *
                 grid.models.size());
  for (const double gamma : options.gammas) {
    for (const double angle : options.angles_deg) {
      for (const int points : options.points) {
        for (const GridModel& model : grid.models) {
          scenes.push_back(grid_scene(gamma, angle, points, model));
        }
      }
    }
  }
  grid.cells.resize(scenes.size());
  std::mutex mutex;
  std::int64_t done = 0;
  tbb::parallel_for(std::size_t{0}, scenes.size(), [&](std::size_t i) {
    grid.cells[i] = compare_at(scenes[i]);
    if (!progress) return;
    const std::lock_guard<std::mutex> lock(mutex);
    progress(++done, static_cast<std::int64_t>(scenes.size()));
  });
  return grid;
}

}  // namespace dlo::compare
