#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dlo/energy_model/status.hpp"
#include "span.hpp"

namespace dlo::energy_model {

/// Tangents at arc lengths of a span, as a start.
using TangentField = std::function<Eigen::Matrix3Xd(const Eigen::VectorXd&)>;

/// Elevation beyond which the tangent is too near to its axis for the polynomials to be smooth
/// [rad].
inline constexpr double largest_elevation = 1.2;

struct SpanOptions {
  int terms = 0;  ///< 0: as many as `tolerance` needs
  double tolerance = 1e-10;
  int max_evaluations = 2000;
  bool all = false;     ///< every equilibrium that the starts lead to
  TangentField start;   ///< instead of the search
  int least_terms = 0;  ///< what resolves the start
};

struct [[nodiscard]] SpanSolution {
  SolveStatus status = SolveStatus::not_run;
  std::string message = "never ran";
  int evaluations = 0;
  int terms = 0;
  double residual = -1;  ///< of the gradient and the constraints
  double energy = 0;     ///< in EI/l
  double smallest_curvature =
      0;  ///< eigenvalue of the projected second variation, sideways included
  std::shared_ptr<SpanEnergy> model;
  Eigen::VectorXd x;
  Eigen::VectorXd multipliers;
};

/// Equilibria of a span, lowest energy first: the search's best one, or all of them. Never empty; a
/// failure is a single solution that says so.
[[nodiscard]] std::vector<SpanSolution> solve_span(const Span& span, const SpanOptions& options);

}  // namespace dlo::energy_model
