#pragma once

#include <Eigen/Core>
#include <vector>

#include "dlo/compare/fitted_material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/shape_file.hpp"
#include "least_squares/fitted_rods.hpp"
#include "least_squares/gauss_newton.hpp"
#include "least_squares/measured_shapes.hpp"
#include "wire/wire_numbers.hpp"

namespace dlo::compare {

/// A wire's numbers, and the shapes that they are fitted to. What is given outlives it.
struct WireProblem {
  /// @param with_density  it is the second number, after E
  WireProblem(const std::vector<Scene>& said, const std::vector<MeasuredShape>& of,
              MeasuredShapes& against, const MaterialFitOptions& asked, bool with_density);

  const std::vector<Scene>& scenes;  ///< as they are said, of each shape one
  const std::vector<MeasuredShape>& shapes;
  MeasuredShapes& measured;  ///< the shapes, whose time limit counts
  const MaterialFitOptions& options;
  bool density;
  std::vector<WireNumber> numbers;
  FittedRods::SceneAt scene_at;  ///< of a shape, at some values of the numbers

  /// The first number that has its own value: of natural curvature, if any.
  [[nodiscard]] Eigen::Index first_of_others() const;
  /// Those that are a shape's own; none: those that are of all.
  [[nodiscard]] bool is_own(std::size_t number, std::size_t shape) const {
    return numbers[number].described.shape == shape;
  }

  /// @param terms  of natural curvature that are fitted, the others stay
  [[nodiscard]] FittedRods rods(int terms) const;

  /// Of log E, where it is looked for. Weight makes a rope of a softer rod, whose shape is the same
  /// with any E; at least two decades are looked at.
  [[nodiscard]] double lowest() const;
  /// How steps are made.
  [[nodiscard]] GaussNewtonOptions steps() const;
  /// The same for a fit from which another one goes on.
  [[nodiscard]] GaussNewtonOptions coarse_steps() const;
  /// The energy model's own error: no noise is taken to be less [m].
  [[nodiscard]] double least_noise() const;

  /// @throws ConvergenceError if that leads to no fit
  void descend(GaussNewton& fit) const;
};

}  // namespace dlo::compare
