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

/// A wire's numbers, and the shapes to which they are fitted. All references must outlive it.
struct WireProblem {
  /// @param with_density  whether the density is the second number, after E
  WireProblem(const std::vector<Scene>& said, const std::vector<MeasuredShape>& of,
              MeasuredShapes& against, const MaterialFitOptions& asked, bool with_density);

  const std::vector<Scene>& scenes;  ///< scenes as given, one per shape
  const std::vector<MeasuredShape>& shapes;
  MeasuredShapes& measured;  ///< the shapes, with their time limit
  const MaterialFitOptions& options;
  bool density;
  std::vector<WireNumber> numbers;
  FittedRods::SceneAt scene_at;  ///< scene of a shape, at some values of the numbers

  /// Returns the index of the first number after E, density and GJ: of natural curvature, if
  /// fitted.
  [[nodiscard]] Eigen::Index first_of_others() const;
  /// Whether a number belongs to one shape alone. @param shape  index of the shape
  [[nodiscard]] bool is_own(std::size_t number, std::size_t shape) const {
    return numbers[number].described.shape == shape;
  }

  /// Returns the rods of the shapes.
  /// @param terms  number of fitted terms of natural curvature, the others are constant
  [[nodiscard]] FittedRods rods(int terms) const;

  /// Returns the lower bound of log E in the search. The weight makes a softer rod a rope, whose
  /// shape does not depend on E. The search covers at least two decades.
  [[nodiscard]] double lowest() const;
  /// Returns the options of the iteration.
  [[nodiscard]] GaussNewtonOptions steps() const;
  /// Returns the options of a fit from which another one starts.
  [[nodiscard]] GaussNewtonOptions coarse_steps() const;
  /// Returns the error of the energy model, the lower bound of any noise [m].
  [[nodiscard]] double least_noise() const;

  /// Minimises the deviance. @throws ConvergenceError if the iteration does not converge
  void descend(GaussNewton& fit) const;
};

}  // namespace dlo::compare
