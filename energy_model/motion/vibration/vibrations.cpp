#include "dlo/energy_model/vibrations.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/deadline.hpp"
#include "base/legendre.hpp"
#include "base/require.hpp"
#include "base/sized_samples.hpp"
#include "frames/position_operator.hpp"
#include "problem/rod_law.hpp"
#include "problem/split.hpp"
#include "search/known_shape.hpp"
#include "strain/span_energy.hpp"
#include "vibration/span_modes.hpp"

namespace dlo::energy_model {
namespace {

/// Fraction of a mode's kinetic energy out of (or in) the plane up to which it counts as rounding.
constexpr double rounding_share = 1e-9;
/// Largest component of tangents out of its plane for a planar shape.
constexpr double plane_rounding = 1e-9;

/// Largest difference of tangents between two solutions of the same equilibrium.
constexpr double same_tangents = 1e-6;
/// Value of omega_squared, divided by EI / (m l^3), below which errors are no longer relative:
/// smaller values belong to rigid-body modes and rounding.
constexpr double zero_frequency_threshold = 1e-2;

/// Function that returns the spans of a rod in equilibrium with a number of coefficients, all in
/// space.
using SpansAtRest = std::function<std::vector<PlacedSolution>(int terms, SpanWorkspace&)>;

/// Axes of a shape; the last one is normal to its plane.
struct ShapeAxes {
  Eigen::Matrix3d rows = Eigen::Matrix3d::Identity();
  bool flat = false;  ///< whether the shape is planar
};

/// Finds the axes of a shape. @param tangents  3 x nodes
ShapeAxes shape_axes(const Eigen::Matrix3Xd& tangents) {
  ShapeAxes result;
  result.flat = tangents.row(2).cwiseAbs().maxCoeff() < plane_rounding;
  if (result.flat) return result;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tangents * tangents.transpose());
  result.rows = solver.eigenvectors().rowwise().reverse().transpose();
  result.flat = (result.rows.row(2) * tangents).cwiseAbs().maxCoeff() < plane_rounding;
  return result;
}

struct VibratingSpan {
  PlacedSpan placed;
  PositionOperator reach;
  std::array<Eigen::MatrixXd, 3> tangents;  ///< derivatives by the unknowns, by axis
  SpanModes modes;
  bool flat = false;  ///< whether its shape is planar

  /// Returns the displacement by a mode (derivatives of the tangents, nodes x 3) of the point at an
  /// arc length, along the axes of `mode`.
  [[nodiscard]] Eigen::Vector3d displacement(double at, double length,
                                             const Eigen::MatrixX3d& mode) const {
    const double s = std::clamp(placed.s_of(at, length), 0.0, placed.span.length);
    return mode.transpose() * reach.at(s);
  }

  [[nodiscard]] double begin(double length) const {
    return placed.reversed ? placed.start - placed.span.length * length : placed.start;
  }
  [[nodiscard]] double end(double length) const {
    return begin(length) + placed.span.length * length;
  }
};

class RodVibrations {
 public:
  /// @param known  shape that `spans` has to reproduce; null: no comparison
  RodVibrations(const Problem& problem, const Inertia& inertia, SpansAtRest spans,
                const Equilibrium* known, const VibrationOptions& options)
      : problem_(problem),
        inertia_(inertia),
        spans_at_rest_(std::move(spans)),
        known_(known),
        count_(options.count) {}

  /// Solves for the spans and their modes. @return the reason of a failure; empty on success
  [[nodiscard]] std::string find_modes(int terms) {
    spans_.clear();
    largest_tangent_difference_ = 0;
    for (PlacedSolution& found : spans_at_rest_(terms, workspace_)) {
      SpanSolution& solution = found.solution;
      if (!solution.is_equilibrium() && solution.status != SolveStatus::near_singular) {
        return solution.message;
      }
      add(found);
    }
    return {};
  }

  /// Returns the modes of all spans with the lowest omega_squared, the lowest first; at most
  /// VibrationOptions::count.
  [[nodiscard]] std::vector<VibrationMode> modes() const {
    std::vector<VibrationMode> result;
    for (const std::shared_ptr<const VibratingSpan>& span : spans_) {
      for (Eigen::Index k = 0; k < span->modes.lambdas.size(); ++k) {
        result.push_back(mode(span, k));
      }
    }
    std::ranges::stable_sort(result, {}, &VibrationMode::omega_squared);
    if (result.size() > static_cast<std::size_t>(count_)) {
      result.resize(static_cast<std::size_t>(count_));
    }
    return result;
  }

  /// Whether the vibrating shape is the known one: Newton's method may have converged to another
  /// one, and few coefficients do not resolve it.
  [[nodiscard]] bool matches_known_shape() const {
    return largest_tangent_difference_ <= same_tangents;
  }

  /// Number of unknowns of the largest span.
  [[nodiscard]] Eigen::Index unknowns() const {
    Eigen::Index most = 0;
    for (const auto& span : spans_) most = std::max(most, span->tangents[0].cols());
    return most;
  }

 private:
  void add(const PlacedSolution& found) {
    const PlacedSpan& placed = found.placed;
    const std::shared_ptr<SpanEnergy>& model = found.solution.model;
    const std::shared_ptr<SpanPoint> at = found.solution.at_x();
    if (known_ != nullptr) {
      const Eigen::Matrix3Xd known =
          field_of(*known_, placed, problem_.length)(model->nodes()).tangents;
      largest_tangent_difference_ =
          std::max(largest_tangent_difference_, (known - at->tangents()).cwiseAbs().maxCoeff());
    }
    Eigen::MatrixXd hessian;
    model->hessian(*at, found.solution.multipliers, hessian);
    const ShapeAxes axes = shape_axes(at->tangents());
    auto span = std::make_shared<VibratingSpan>(
        VibratingSpan{placed,
                      PositionOperator(model->span(), elements_of(model->span()), model->table()),
                      model->tangent_jacobian(*at),
                      {},
                      axes.flat});
    // Twist of a round rod moves no point.
    for (Eigen::MatrixXd& tangents : span->tangents) {
      const Eigen::Index moving = tangents.cols();
      tangents.conservativeResize(Eigen::NoChange, model->size());
      tangents.rightCols(model->size() - moving).setZero();
    }
    const SpanPointOperator points(span->reach);
    const Eigen::VectorXd masses = points.weights_with_density(
        masses_per_length(problem_, inertia_, placed, span->reach.elements()));
    const auto mass_along = [&](const Eigen::MatrixXd& tangents) {
      Eigen::MatrixXd result = mass_matrix(points, masses, tangents);
      for (const PointMass& point : inertia_.point_masses) {
        const double s = placed.s_of(point.at, problem_.length);
        // A point mass at a clamp between two spans does not move, whichever span it is counted in.
        if (!(s >= 0 && s <= placed.span.length)) continue;
        const Eigen::VectorXd moved = tangents.transpose() * span->reach.at(s);
        result += point.mass * moved * moved.transpose();
      }
      return result;
    };
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(model->size(), model->size());
    for (const Eigen::MatrixXd& tangents : span->tangents) mass += mass_along(tangents);
    const Eigen::MatrixXd across = axes.rows(2, 0) * span->tangents[0] +
                                   axes.rows(2, 1) * span->tangents[1] +
                                   axes.rows(2, 2) * span->tangents[2];
    // One mode more than requested, so that two modes of equal frequency are separated together.
    span->modes = span_modes(hessian, at->jacobian, mass, mass_along(across), count_ + 1);
    spans_.push_back(std::move(span));
  }

  [[nodiscard]] VibrationMode mode(const std::shared_ptr<const VibratingSpan>& span,
                                   Eigen::Index k) const {
    const double l = problem_.length;
    VibrationMode result;
    result.omega_squared = span->modes.lambdas[k] * bending_unit(problem_) / (l * l * l);
    const double outside = span->modes.outside[k];
    if (span->flat) {
      result.plane = outside < rounding_share       ? ModePlane::in
                     : outside > 1 - rounding_share ? ModePlane::out
                                                    : ModePlane::mixed;
    }
    result.begin = span->begin(l);
    result.end = span->end(l);
    Eigen::MatrixX3d shape(span->reach.nodes().size(), 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      shape.col(static_cast<Eigen::Index>(axis)) = span->tangents[axis] * span->modes.shapes.col(k);
    }
    shape *= span->placed.frame;
    // Normalises by the farthest displacement among these points.
    constexpr int samples = 400;
    Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
    for (int i = 0; i <= samples; ++i) {
      const Eigen::Vector3d here =
          span->displacement(result.begin + (result.end - result.begin) * i / samples, l, shape);
      if (here.norm() > farthest.norm()) farthest = here;
    }
    Eigen::Index axis = 0;
    farthest.cwiseAbs().maxCoeff(&axis);
    shape /= std::copysign(farthest.norm(), farthest[axis]);
    result.shape = [span, shape, l, begin = result.begin,
                    end = result.end](std::span<const double> arc_lengths) {
      Eigen::Matrix3Xd points = sized_samples(arc_lengths, l).points;
      for (std::size_t i = 0; i < arc_lengths.size(); ++i) {
        const bool on_span = arc_lengths[i] >= begin && arc_lengths[i] <= end;
        points.col(static_cast<Eigen::Index>(i)) =
            on_span ? span->displacement(arc_lengths[i], l, shape) : Eigen::Vector3d::Zero();
      }
      return points;
    };
    return result;
  }

  const Problem& problem_;
  const Inertia& inertia_;
  SpansAtRest spans_at_rest_;
  const Equilibrium* known_;
  Eigen::Index count_;
  SpanWorkspace workspace_;
  std::vector<std::shared_ptr<const VibratingSpan>> spans_;
  // Largest difference of a tangent's component from the known shape.
  double largest_tangent_difference_ = 0;
};

void check_options(const VibrationOptions& options) {
  const char* where = "vibrations";
  require(options.count > 0, where, "count", options.count, "> 0");
  require(options.tolerance > 0, where, "tolerance", options.tolerance, "> 0");
  require(options.time_limit > 0, where, "time_limit", options.time_limit, "> 0");
}

/// Largest deviation of a straight rod's grips from the line, divided by the length of rod from the
/// first grip, and of their directions; by rounding.
constexpr double straight_rounding = 1e-9;

/// Returns the problem with a small slack between its grips, which is required of problems. A
/// straight rod does not depend on it.
Problem with_slack(const Problem& problem) {
  Problem result = problem;
  for (Grip& grip : result.grips) {
    grip.position = problem.grips.front().position +
                    (1 - 1e-8) * (grip.position - problem.grips.front().position);
  }
  return result;
}

void require_energy_in_space(const Problem& problem) {
  require(!problem.confined_to_plane, "vibrations", "confined_to_plane", 1,
          "false: only solve_energy() confines a rod to a plane");
  require(!has_couples(problem), "vibrations", "torque of a load", 1,
          "0: a couple has no potential out of the plane of the rod");
}

/// Checks that there are no weight, loads, obstacles or natural strains; not the clamps' frames.
/// @throws std::invalid_argument otherwise
void require_no_bending_loads(const Problem& problem) {
  const char* where = "taut_vibrations";
  double weight = 0;
  for (const RodPart& part : rod_parts(problem)) {
    weight = std::max({weight, part.weight_per_length.norm(), part.weight_slope.norm()});
  }
  require(weight == 0, where, "weight_per_length", weight,
          "0: a rod with weight is not straight under a finite uniform tension");
  for (const Load& load : problem.loads) {
    require(load.force.norm() == 0, where, "load", load.force.norm(), "0 for a rod held straight");
  }
  require(problem.obstacles.empty(), where, "number of obstacles",
          static_cast<double>(problem.obstacles.size()), "0 for a rod held straight");
  require(problem.natural_strains.empty(), where, "number of natural_strains",
          static_cast<double>(problem.natural_strains.size()), "0 for a rod held straight");
}

/// Computes modes with an increasing number of coefficients until they do not change.
/// @param known  shape that `spans` has to reproduce; null: no comparison
Vibrations resolved_vibrations(const Problem& problem, const Inertia& inertia,
                               const SpansAtRest& spans, const Equilibrium* known,
                               const VibrationOptions& options) {
  RodVibrations rod(problem, inertia, spans, known, options);
  Vibrations result{.status = SolveStatus::failed};
  int terms = std::max(16, options.count + 8);
  std::vector<double> last;
  const double neutral_square = zero_frequency_threshold * bending_unit(problem) /
                                (total_mass(problem, inertia) * std::pow(problem.length, 3));
  while (true) {
    const std::string problem_found = rod.find_modes(terms);
    if (!problem_found.empty()) {
      result.message = problem_found;
      return result;
    }
    result.modes = rod.modes();
    result.terms = terms;
    const bool as_many = result.modes.size() == last.size();
    double largest = 0;
    for (std::size_t i = 0; i < result.modes.size() && i < last.size(); ++i) {
      const double square = result.modes[i].omega_squared;
      // The relative error of omega is half of that of its square.
      result.modes[i].error =
          std::abs(square - last[i]) / (2 * std::max(std::abs(square), neutral_square));
      largest = std::max(largest, result.modes[i].error);
    }
    if (as_many && largest <= options.tolerance && rod.matches_known_shape()) {
      result.status = SolveStatus::converged;
      result.message = to_string(result.status);
      return result;
    }
    last.clear();
    for (const VibrationMode& mode : result.modes) last.push_back(mode.omega_squared);
    const int next = terms + std::max(6, terms / 2);
    if (next > max_terms || rod.unknowns() * next > Eigen::Index{most_unknowns} * terms) break;
    terms = next;
  }
  result.status = SolveStatus::not_verified;
  result.message = rod.matches_known_shape()
                       ? "the lowest frequencies still change with the number of terms"
                       : "the equilibrium was not found with the number of terms of the modes";
  return result;
}

}  // namespace

double VibrationMode::omega() const { return std::sqrt(omega_squared); }

Vibrations vibrations(const Problem& problem, const Inertia& inertia, const Equilibrium& known,
                      const VibrationOptions& options) {
  check(problem);
  require_energy_in_space(problem);
  check(problem, inertia, "vibrations");
  check_options(options);
  Vibrations result{.status = SolveStatus::failed};
  if (!known.sample || !known.contacts.empty()) {
    result.message = known.sample
                         ? "the rod touches a rigid obstacle and would lift off while it vibrates"
                         : "there is no equilibrium to vibrate about: " + known.message;
    return result;
  }
  const Deadline deadline(options.time_limit);
  result = resolved_vibrations(
      problem, inertia,
      [&](int terms, SpanWorkspace& workspace) {
        return spans_in_space(problem, known, terms, deadline, workspace);
      },
      &known, options);
  const bool late = result.status == SolveStatus::failed && deadline.passed();
  if (late) result.status = SolveStatus::time_limit;
  return result;
}

bool is_held_straight(const Problem& problem) {
  std::vector<Grip> grips = problem.grips;
  std::sort(grips.begin(), grips.end(), [](const Grip& a, const Grip& b) { return a.at < b.at; });
  for (std::size_t i = 0; i < grips.size(); ++i) {
    if (!grips[i].direction) return false;
    const Eigen::Vector3d along = grips[0].direction->normalized();
    const double rod = grips[i].at - grips[0].at;
    const Eigen::Vector3d offset = grips[i].position - grips[0].position - rod * along;
    if (!(offset.norm() <= straight_rounding * rod)) return false;
    if (!((grips[i].direction->normalized() - along).norm() <= straight_rounding)) return false;
  }
  return grips.size() > 1;
}

Vibrations taut_vibrations(const Problem& problem, const Inertia& inertia, double tension,
                           const VibrationOptions& options) {
  const char* where = "taut_vibrations";
  const Problem slack = with_slack(problem);
  check(slack);
  check(slack, inertia, where);
  check_options(options);
  require_finite(where, "tension", tension);
  require_energy_in_space(problem);
  require_no_bending_loads(problem);
  if (!is_held_straight(problem)) {
    throw std::invalid_argument(std::string(where) +
                                ": the grips do not hold the rod between them straight (allowed: "
                                "two or more clamps on a line along their directions, as far "
                                "apart as the rod between them is long)");
  }
  const double force_unit = bending_unit(problem) / (problem.length * problem.length);
  return resolved_vibrations(
      slack, inertia,
      [&](int terms, SpanWorkspace& workspace) {
        std::vector<PlacedSolution> spans;
        for (PlacedSpan& placed : split(slack)) {
          if (placed.frames) {
            throw std::invalid_argument(std::string(where) + ": clamps hold the rod's frame");
          }
          placed.span.planar = false;
          SpanSolution solution;
          solution.model = workspace.model(placed.span, terms);
          solution.terms = terms;
          solution.x = Eigen::VectorXd::Zero(solution.model->size());
          solution.multipliers = Eigen::VectorXd::Zero(solution.model->constraints());
          if (!placed.span.holds.empty()) {
            solution.multipliers.head<3>() = tension / force_unit * *placed.span.start_direction;
          }
          solution.finish(SolveStatus::converged);
          spans.push_back({std::move(placed), std::move(solution)});
        }
        return spans;
      },
      nullptr, options);
}

}  // namespace dlo::energy_model
