#include "fit/measured_shapes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "dlo/compare/error.hpp"
#include "polygon/energy_problems.hpp"

namespace dlo::compare {
namespace {

/// Numbers that are measured of a shape.
int measured_numbers(const Aligner& aligner, bool flat) {
  const int per_point = (aligner.arc_lengths() == ArcLengths::nearest ? 2 : 3) - (flat ? 1 : 0);
  return per_point * static_cast<int>(aligner.points());
}

/// Numbers of a shape's frame.
int numbers_of_frame(bool flat, PoseFreedom pose) {
  constexpr int frame[] = {0, 3, 4, 6};
  constexpr int flat_frame[] = {0, 2, 2, 3};
  return (flat ? flat_frame : frame)[static_cast<std::size_t>(pose)];
}

}  // namespace

MeasuredShapes::MeasuredShapes(const std::vector<Scene>& scenes,
                               const std::vector<MeasuredShape>& shapes,
                               const MaterialFitOptions& options,
                               std::chrono::steady_clock::time_point begin)
    : options_(options), begin_(begin) {
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const Eigen::Vector3d up = up_of(scenes[i], options.pose);
    Aligner aligner(shapes[i], scenes[i].length,
                    {.pose = options.pose,
                     .arc_lengths = options.arc_lengths,
                     .weights = PointWeights::equal,
                     .up = up});
    const Eigen::Index columns = aligner.free_coordinates();
    shapes_.push_back({std::move(aligner), scenes[i].length, lies_in_a_plane(shapes[i].points), up,
                       frame_columns_});
    frame_columns_ += columns;
  }
}

Eigen::Index MeasuredShapes::points() const {
  Eigen::Index sum = 0;
  for (const OneShape& shape : shapes_) sum += shape.aligner.points();
  return sum;
}

int MeasuredShapes::numbers() const {
  int sum = 0;
  for (const OneShape& shape : shapes_) sum += measured_numbers(shape.aligner, shape.flat);
  return sum - frame_numbers();
}

int MeasuredShapes::frame_numbers() const {
  int sum = 0;
  for (const OneShape& shape : shapes_) sum += numbers_of_frame(shape.flat, options_.pose);
  return sum;
}

energy_model::Equilibrium MeasuredShapes::solve(const Scene& scene,
                                                const energy_model::Equilibrium* start) {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
  const double limit = options_.solve.time_limit;
  const double left = limit * static_cast<double>(size()) - spent.count();
  if (!(left > 0)) {
    throw ConvergenceError(
        fmt::format("calibrate: not done within {:g} s{}, after {} equilibria (--time-limit)",
                    limit, size() > 1 ? " per scene" : "", solves_));
  }
  ++solves_;
  try {
    energy_model::Equilibrium rod = energy_model::solve_energy(
        energy_problem(scene), {.terms = options_.solve.terms,
                                .max_evaluations = options_.solve.max_evaluations,
                                .time_limit = std::min(limit, left),
                                .start = start});
    evaluations_ += rod.evaluations;
    return rod;
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", scene.file, error.what()));
  }
}

double MeasuredShapes::squares(std::size_t shape, const energy_model::Equilibrium& rod) const {
  return alignment(shape, rod).mean_square * static_cast<double>(shapes_[shape].aligner.points());
}

std::vector<ResidualSeries> MeasuredShapes::residuals(std::size_t shape, const Curve& curve,
                                                      const Alignment& alignment,
                                                      const std::vector<Movement>& movements,
                                                      Eigen::Index numbers) const {
  const LaidShape laid{.index = shape,
                       .alignment = alignment,
                       .curve = curve,
                       .flat = shapes_[shape].flat,
                       .pose = options_.pose,
                       .up = shapes_[shape].up,
                       .first_of_frame = shapes_[shape].columns};
  return residual_series(laid, movements, frame_columns_ + numbers);
}

}  // namespace dlo::compare
