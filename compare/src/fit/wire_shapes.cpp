#include "fit/wire_shapes.hpp"

#include <cmath>
#include <utility>

#include "dlo/compare/error.hpp"

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

WireShapes::WireShapes(const std::vector<Scene>& scenes, MeasuredShapes& measured,
                       const MaterialFitOptions& options, const std::vector<WireNumber>& numbers)
    : scenes_(scenes), measured_(measured), numbers_(numbers), last_(scenes.size()) {
  if (options.natural_curvature_terms == 0 || !(options.direction_tolerance > 0)) return;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!measured.is_flat(i)) scenes_[i] = with_said_frame(std::move(scenes_[i]));
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
  try {
    const Scene changed = scene(shape, values);
    const bool follows = last_[shape].has_value();
    energy_model::Equilibrium rod = measured_.solve(changed, follows ? &*last_[shape] : nullptr);
    if (follows && !energy_model::succeeded(rod.status)) rod = measured_.solve(changed, nullptr);
    if (!energy_model::succeeded(rod.status)) return std::nullopt;
    return rod;
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
      result.emplace_back(measured_.frame_columns() + number,
                          Eigen::Matrix3Xd::Zero(3, here.cols()));
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
      Eigen::Matrix3Xd way = measured_.curve(shape, *rod).points(s) - here;
      if (way.colwise().norm().maxCoeff() < least_movement * scenes_[shape].length) way.setZero();
      result.emplace_back(measured_.frame_columns() + number, way / stride);
      break;
    }
  }
  return result;
}

std::optional<std::vector<ResidualSeries>> WireShapes::residuals(const Eigen::VectorXd& values,
                                                                 Columns columns) {
  std::vector<ResidualSeries> result;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    std::optional<energy_model::Equilibrium> rod = solve(i, values);
    if (!rod) return std::nullopt;
    last_[i] = std::move(rod);
    const Curve curve = measured_.curve(i, *last_[i]);
    const Alignment alignment = measured_.alignment(i, *last_[i]);
    std::vector<Movement> moved;
    if (columns == Columns::all) {
      const std::vector<double>& s = alignment.shape.arc_length;
      std::optional<std::vector<Movement>> found = movements(i, values, curve.points(s), s);
      if (!found) return std::nullopt;
      moved = std::move(*found);
    }
    const auto count = static_cast<Eigen::Index>(numbers_.size());
    for (ResidualSeries& series : measured_.residuals(i, curve, alignment, moved, count)) {
      result.push_back(std::move(series));
    }
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
    result.squares[i] = measured_.squares(i, *result.rods[i]);
  }
  return result;
}

std::vector<Alignment> WireShapes::alignments(const Eigen::VectorXd& values) {
  std::vector<Alignment> result;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    const std::optional<energy_model::Equilibrium> rod = solve(i, values);
    if (!rod) break;
    result.push_back(measured_.alignment(i, *rod));
  }
  return result;
}

}  // namespace dlo::compare
