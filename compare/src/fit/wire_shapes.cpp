#include "fit/wire_shapes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "dlo/compare/error.hpp"
#include "polygon/energy_problems.hpp"

namespace dlo::compare {
namespace {

/// A movement below this share of the length is the solver's error (1e-10 l), not the number's.
constexpr double least_movement = 1e-9;

/// With its first clamp's frame said, so that it goes on holding it when it is turned out of the
/// scene's plane.
Scene with_said_frame(Scene scene) {
  Scene bent = scene;
  bent.natural_strain.y() += 1 / scene.length;
  const Eigen::Matrix3d frame = bent.first_frame();
  Gripper* first = nullptr;
  for (Gripper& gripper : scene.grippers) {
    if (gripper.direction && (first == nullptr || gripper.at < first->at)) first = &gripper;
  }
  if (first->frame && first->frame->d1) return scene;
  const double roll = first->frame ? first->frame->roll : 0;
  first->frame = FrameHold{.d1 = frame.col(0), .roll = roll};
  return scene;
}

}  // namespace

WireShapes::WireShapes(const std::vector<Scene>& scenes, const std::vector<MeasuredShape>& shapes,
                       const MaterialFitOptions& options, const std::vector<WireNumber>& numbers,
                       std::chrono::steady_clock::time_point begin)
    : scenes_(scenes), options_(options), numbers_(numbers), last_(scenes.size()), begin_(begin) {
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    aligners_.emplace_back(shapes[i], scenes[i].length,
                           AlignOptions{.pose = options.pose,
                                        .arc_lengths = options.arc_lengths,
                                        .weights = PointWeights::equal,
                                        .up = up_of(scenes[i], options.pose)});
    flat_.push_back(lies_in_a_plane(shapes[i].points));
    frame_columns_ += aligners_.back().free_coordinates();
    const bool turned_out = options.direction_tolerance > 0 && !flat_.back();
    if (options.natural_curvature_terms > 0 && turned_out) {
      scenes_[i] = with_said_frame(std::move(scenes_[i]));
    }
  }
}

Scene WireShapes::scene(std::size_t shape, const Eigen::VectorXd& values) const {
  Scene result = scenes_[shape];
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const std::optional<std::size_t>& whose = numbers_[k].described.shape;
    if (whose && *whose != shape) continue;
    numbers_[k].change(result, values[static_cast<Eigen::Index>(k)]);
  }
  return result;
}

std::optional<energy_model::Equilibrium> WireShapes::solve(std::size_t shape,
                                                           const Eigen::VectorXd& values) {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin_;
  const double limit = options_.solve.time_limit;
  const double left = limit * static_cast<double>(scenes_.size()) - spent.count();
  if (!(left > 0)) {
    throw ConvergenceError(
        fmt::format("calibrate: not done within {:g} s per scene, after {} equilibria "
                    "(--time-limit)",
                    limit, solves_));
  }
  const Scene changed = scene(shape, values);
  const bool follows = last_[shape].has_value();
  const auto solve_from = [&](const energy_model::Equilibrium* start) {
    ++solves_;
    energy_model::Equilibrium rod = energy_model::solve_energy(
        energy_problem(changed), {.terms = options_.solve.terms,
                                  .max_evaluations = options_.solve.max_evaluations,
                                  .time_limit = std::min(limit, left),
                                  .start = start});
    evaluations_ += rod.evaluations;
    return rod;
  };
  try {
    energy_model::Equilibrium rod = solve_from(follows ? &*last_[shape] : nullptr);
    if (follows && !energy_model::succeeded(rod.status)) rod = solve_from(nullptr);
    if (!energy_model::succeeded(rod.status)) return std::nullopt;
    return rod;
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", changed.file, error.what()));
  } catch (const InputError&) {
    // Grippers that a step moved farther apart than the rod between them.
    return std::nullopt;
  }
}

std::optional<std::vector<Movement>> WireShapes::movements(std::size_t shape,
                                                           const Eigen::VectorXd& values,
                                                           const Eigen::Matrix3Xd& here,
                                                           const std::vector<double>& s) {
  std::vector<Movement> result;
  for (std::size_t k = 0; k < numbers_.size(); ++k) {
    const std::optional<std::size_t>& whose = numbers_[k].described.shape;
    if (whose && *whose != shape) continue;
    const auto number = static_cast<Eigen::Index>(k);
    if (numbers_[k].stride == 0) {
      result.emplace_back(frame_columns_ + number, Eigen::Matrix3Xd::Zero(3, here.cols()));
      continue;
    }
    // The side on which there is a shape: a straight rod's grippers come nearer, not farther.
    for (const double stride : {numbers_[k].stride, -numbers_[k].stride}) {
      Eigen::VectorXd beside = values;
      beside[number] += stride;
      const std::optional<energy_model::Equilibrium> rod = solve(shape, beside);
      if (!rod) {
        if (stride < 0) return std::nullopt;
        continue;
      }
      const Curve curve(rod->sample, scenes_[shape].length);
      Eigen::Matrix3Xd way = curve.points(s) - here;
      if (way.colwise().norm().maxCoeff() < least_movement * scenes_[shape].length) way.setZero();
      result.emplace_back(frame_columns_ + number, way / stride);
      break;
    }
  }
  return result;
}

std::optional<std::vector<ResidualSeries>> WireShapes::residuals(const Eigen::VectorXd& values,
                                                                 Columns columns) {
  std::vector<ResidualSeries> result;
  Eigen::Index frame = 0;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    std::optional<energy_model::Equilibrium> rod = solve(i, values);
    if (!rod) return std::nullopt;
    const Curve curve(rod->sample, scenes_[i].length);
    last_[i] = std::move(rod);
    const Alignment alignment = aligners_[i].align(curve);
    std::vector<Movement> moved;
    if (columns == Columns::all) {
      const std::vector<double>& s = alignment.shape.arc_length;
      std::optional<std::vector<Movement>> found = movements(i, values, curve.points(s), s);
      if (!found) return std::nullopt;
      moved = std::move(*found);
    }
    const LaidShape laid{.index = i,
                         .alignment = alignment,
                         .curve = curve,
                         .flat = flat_[i],
                         .pose = options_.pose,
                         .up = up_of(scenes_[i], options_.pose),
                         .first_of_frame = frame};
    const auto count = static_cast<Eigen::Index>(numbers_.size());
    for (ResidualSeries& series : residual_series(laid, moved, frame_columns_ + count)) {
      result.push_back(std::move(series));
    }
    frame += aligners_[i].free_coordinates();
  }
  return result;
}

void WireShapes::go_on_from(Rods rods) { last_ = std::move(rods); }

WireShapes::State WireShapes::state(const Eigen::VectorXd& values) {
  State result;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    result.rods.push_back(solve(i, values));
    result.squares.push_back(INFINITY);
    if (!result.rods[i]) continue;
    last_[i] = result.rods[i];
    const Curve curve(result.rods[i]->sample, scenes_[i].length);
    result.squares[i] =
        aligners_[i].align(curve).mean_square * static_cast<double>(aligners_[i].points());
  }
  return result;
}

std::vector<Alignment> WireShapes::alignments(const Eigen::VectorXd& values) {
  std::vector<Alignment> result;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const std::optional<energy_model::Equilibrium> rod = solve(i, values);
    if (!rod) break;
    result.push_back(aligners_[i].align(Curve(rod->sample, scenes_[i].length)));
  }
  return result;
}

}  // namespace dlo::compare
