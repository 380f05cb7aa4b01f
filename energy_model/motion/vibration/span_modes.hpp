#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "dlo/energy_model/vibrations.hpp"
#include "frames/position_operator.hpp"
#include "problem/split.hpp"

namespace dlo::energy_model {

/// Solutions of H v = lambda M v on the free directions, by ascending lambda.
struct SpanModes {
  Eigen::VectorXd lambdas;
  Eigen::MatrixXd shapes;   ///< v, by column, v^T M v = 1
  Eigen::VectorXd outside;  ///< fraction of the kinetic energy in the movement `outside` [-]
};

/// Computes the modes of a span. Modes of equal frequency are chosen so that their movement
/// `outside` is largest and smallest.
/// @param mass     M
/// @param outside  mass matrix of the movement along one axis
/// @param count    number of modes; fewer are returned if fewer have inertia, and none if no
///                 H + shift M is positive definite
[[nodiscard]] SpanModes span_modes(const Eigen::MatrixXd& hessian, const Eigen::MatrixXd& jacobian,
                                   const Eigen::MatrixXd& mass, const Eigen::MatrixXd& outside,
                                   Eigen::Index count);

/// Checks masses. @throws std::invalid_argument naming the value that is out of range, and the
/// function
void check(const Problem& problem, const Inertia& inertia, std::string_view function);

/// Returns the mass of the rod and its point masses [kg].
[[nodiscard]] double total_mass(const Problem& problem, const Inertia& inertia);

/// Returns the mass per length of each of a span's elements, times the length unit of the span
/// [kg].
[[nodiscard]] std::vector<double> masses_per_length(const Problem& problem, const Inertia& inertia,
                                                    const PlacedSpan& placed,
                                                    const std::vector<Element>& elements);

/// Returns the mass matrix M of the movement along one axis: the kinetic energy is v^T M v / 2 with
/// the unknowns' velocities v.
/// @param masses    of the points of a span
/// @param tangents  derivatives of the tangents' component along the axis by the unknowns, nodes x
///   unknowns
[[nodiscard]] Eigen::MatrixXd mass_matrix(const SpanPointOperator& reach,
                                          const Eigen::VectorXd& masses,
                                          const Eigen::MatrixXd& tangents);

}  // namespace dlo::energy_model
