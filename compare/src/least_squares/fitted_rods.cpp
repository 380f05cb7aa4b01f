#include "least_squares/fitted_rods.hpp"

#include <cmath>
#include <utility>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

/// Movement, divided by the length, below which it is the error of the solver (1e-10 l) and not an
/// effect of the number.
constexpr double least_movement = 1e-9;

}  // namespace

std::optional<energy_model::Equilibrium> FittedRods::solve(std::size_t shape,
                                                           const Eigen::VectorXd& values) {
  try {
    const Scene changed = scene_(shape, values);
    const bool follows = last_[shape].has_value();
    energy_model::Equilibrium rod =
        measured_.solve(shape, changed, follows ? &*last_[shape] : nullptr);
    if (follows && !energy_model::succeeded(rod.status))
      rod = measured_.solve(shape, changed, nullptr);
    if (!energy_model::succeeded(rod.status)) return std::nullopt;
    return rod;
  } catch (const InputError&) {
    // A step may move grippers farther apart than the rod between them.
    return std::nullopt;
  }
}

std::optional<std::vector<Movement>> FittedRods::movements(std::size_t shape,
                                                           const Eigen::VectorXd& values,
                                                           const Curve& here,
                                                           const std::vector<double>& s) {
  std::vector<Movement> result;
  const Eigen::Matrix3Xd points = here.points(s);
  for (std::size_t k = 0; k < unknowns_.size(); ++k) {
    const Unknown& unknown = unknowns_[k];
    if (unknown.shape && *unknown.shape != shape) continue;
    const auto number = static_cast<Eigen::Index>(k);
    if (unknown.difference_step == 0) {
      result.emplace_back(measured_.frame_columns() + number,
                          Eigen::Matrix3Xd::Zero(3, points.cols()));
      continue;
    }
    // Differences are taken to the side on which a shape exists: the grippers of a straight rod can
    // only approach each other.
    for (const double difference_step : {unknown.difference_step, -unknown.difference_step}) {
      Eigen::VectorXd perturbed = values;
      perturbed[number] += difference_step;
      const std::optional<energy_model::Equilibrium> rod = solve(shape, perturbed);
      if (!rod) {
        if (difference_step < 0) return std::nullopt;
        continue;
      }
      Eigen::Matrix3Xd movement = measured_.curve(shape, *rod).points(s) - points;
      if (movement.colwise().norm().maxCoeff() < least_movement * here.length()) movement.setZero();
      result.emplace_back(measured_.frame_columns() + number, movement / difference_step);
      break;
    }
  }
  return result;
}

std::optional<std::vector<ResidualSeries>> FittedRods::residuals(const Eigen::VectorXd& values,
                                                                 Columns columns) {
  std::vector<ResidualSeries> result;
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    std::optional<energy_model::Equilibrium> rod = solve(i, values);
    if (!rod) return std::nullopt;
    last_[i] = std::move(rod);
    const Curve curve = measured_.curve(i, *last_[i]);
    const Alignment alignment = measured_.alignment(i, *last_[i]);
    std::vector<Movement> moved;
    if (columns == Columns::all) {
      const std::vector<double>& s = alignment.shape.arc_length;
      std::optional<std::vector<Movement>> found = movements(i, values, curve, s);
      if (!found) return std::nullopt;
      moved = std::move(*found);
    }
    const auto count = static_cast<Eigen::Index>(unknowns_.size());
    for (ResidualSeries& series : measured_.residuals(i, curve, alignment, moved, count)) {
      result.push_back(std::move(series));
    }
  }
  return result;
}

FittedRods::State FittedRods::state(const Eigen::VectorXd& values) {
  State result;
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    result.rods.push_back(solve(i, values));
    result.sum_of_squares.push_back(INFINITY);
    if (!result.rods[i]) continue;
    last_[i] = result.rods[i];
    result.sum_of_squares[i] = measured_.sum_of_squares(i, *result.rods[i]);
  }
  return result;
}

std::vector<Alignment> FittedRods::alignments(const Eigen::VectorXd& values) {
  std::vector<Alignment> result;
  for (std::size_t i = 0; i < measured_.size(); ++i) {
    const std::optional<energy_model::Equilibrium> rod = solve(i, values);
    if (!rod) break;
    result.push_back(measured_.alignment(i, *rod));
  }
  return result;
}

std::vector<Shape> sampled(const FittedRods::Rods& rods, const std::vector<Scene>& scenes,
                           int samples) {
  std::vector<Shape> result;
  for (std::size_t i = 0; i < rods.size() && rods[i]; ++i) {
    const std::vector<double> s = equal_arc_lengths(scenes[i].length, samples);
    result.push_back({.arc_length = s, .points = rods[i]->sample(s).points});
  }
  return result;
}

}  // namespace dlo::compare
