#include "motion/polygon_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "dlo/compare/error.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/force_model/tangent_stiffness.hpp"
#include "polygon/point_layout.hpp"

namespace dlo::compare {
namespace {

/// Improves a solver's shape by Newton's method until it is at rest to rounding.
Eigen::Matrix3Xd rest_of(const Scene& scene, const Discretisation& polygon,
                         Eigen::Matrix3Xd points) {
  for (const force_model::Grip& grip : polygon.rod.grips) {
    points.middleCols(grip.first_point, grip.targets.cols()) = grip.targets;
  }
  constexpr int most_steps = 50;
  constexpr double at_rest = 1e-9;
  for (int i = 0; i < most_steps; ++i) {
    const force_model::EquilibriumCheck check = force_model::check_equilibrium(polygon.rod, points);
    const double rms = std::sqrt(check.step.colwise().squaredNorm().mean());
    if (!std::isfinite(rms)) break;
    if (rms <= at_rest * scene.length && check.stable) return points;
    points += check.step;
  }
  throw ConvergenceError(fmt::format(
      "{}: the polygon of {} points is not stable where it rests (allowed: other points, law or "
      "c_c)",
      scene.file, polygon.rod.points()));
}

/// Returns the square roots of the masses, in the order of the stiffness matrix.
Eigen::VectorXd mass_roots(const Eigen::VectorXd& masses) {
  return masses.cwiseSqrt().transpose().replicate<3, 1>().reshaped();
}

}  // namespace

MovingPolygon polygon_at_rest(const Scene& scene, const SolveOptions& options) {
  const ForceModelSettings& settings = scene.force_model;
  if (settings.points > most_points_of_modes) {
    throw InputError(fmt::format("{}: force_model.points = {} (allowed here: up to {})", scene.file,
                                 settings.points, most_points_of_modes));
  }
  MovingPolygon result{.discretisation = discretise(scene, settings)};
  const Discretisation& polygon = result.discretisation;
  if (polygon.rod.bending.natural_turns.size() > 0) {
    throw InputError(
        fmt::format("{}: joints of a polygon that are intrinsically curved bend in their plane "
                    "only, so that it has "
                    "no modes out of it (allowed: a rod that is intrinsically straight)",
                    scene.file));
  }
  // The minimiser needs a potential, which the paper's law between unequal segments does not have.
  const Model model = settings.law == BendingLaw::paper ? Model::force : Model::chain;
  const Shape near = solve(scene, model, options).shape;
  result.points = rest_of(scene, polygon, resample(near, polygon.arc_length).points);
  force_model::StiffnessMatrix K = force_model::tangent_stiffness(polygon.rod, result.points);
  result.stiffness = std::move(K.entries);
  result.free = std::move(K.points);
  const PointMasses masses = point_masses(scene, settings);
  result.masses.resize(static_cast<Eigen::Index>(result.free.size()));
  for (Eigen::Index i = 0; i < result.masses.size(); ++i) {
    const auto point = static_cast<std::size_t>(result.free[static_cast<std::size_t>(i)]);
    result.masses[i] = masses.rod[point] + masses.hanging[point];
  }
  return result;
}

PolygonModes polygon_modes(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& masses) {
  const Eigen::VectorXd inverse = mass_roots(masses).cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(inverse.asDiagonal() * stiffness *
                                                              inverse.asDiagonal());
  return {masses, solver.eigenvalues(), inverse.asDiagonal() * solver.eigenvectors()};
}

PolygonModes::Match PolygonModes::nearest(const Eigen::VectorXd& movement) const {
  constexpr double same = 1e-6;
  const Eigen::VectorXd weighed = mass_roots(masses).cwiseAbs2().cwiseProduct(movement);
  const Eigen::VectorXd shares = (shapes.transpose() * weighed).cwiseAbs2() / movement.dot(weighed);
  Match best;
  for (Eigen::Index begin = 0; begin < squares.size();) {
    Eigen::Index end = begin + 1;
    while (end < squares.size() && squares[end] - squares[begin] <= same * std::abs(squares[end])) {
      ++end;
    }
    const double likeness = shares.segment(begin, end - begin).sum();
    if (likeness > best.likeness) best = {squares.segment(begin, end - begin).mean(), likeness};
    begin = end;
  }
  return best;
}

}  // namespace dlo::compare
