#include "dlo/energy_model/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "base/deadline.hpp"
#include "polygon/polygon_energy.hpp"

namespace dlo::energy_model {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
/// Strain that the first, softest stage allows under the acting forces [-].
constexpr double soft_strain = 0.01;
/// RMS of Newton's step at which a stage ends and the next stiffer one begins, in polygon lengths.
constexpr double stage_tolerance = 1e-6;
/// RMS of Newton's step, in polygon lengths, below which missing progress is attributed to
/// rounding.
constexpr double rounding_step = 1e-7;
/// Largest displacement of a coordinate in one step, in polygon lengths.
constexpr double largest_step = 0.2;
/// Initial step, in polygon lengths, below which slow steps with a modified Hessian are treated as
/// an approach to a saddle.
constexpr double first_escape_step = 1e-3;
/// Largest residual force on a free point, divided by the forces that act [-]. The forces on a
/// hundred points then balance within allowed_imbalance. The rounding error of positions times the
/// largest stiffness is allowed as well (verify_result()). A polygon that is compressed between two
/// constraints does not reach a smaller residual.
constexpr double largest_residual_force = 1e-10;

/// Newton's method for one problem, with the data that all steps need.
class PolygonDescent {
 public:
  /// @param problem  the angles of its twists are updated with the points of the result
  PolygonDescent(PolygonProblem& problem, const PolygonOptions& options, const Deadline& deadline,
                 PolygonResult& result)
      : problem_(problem),
        options_(options),
        deadline_(deadline),
        result_(result),
        length_(problem.rest_lengths.sum()),
        axes_(problem.natural_turns.size() > 0 ? 2 : 3),
        index_(static_cast<std::size_t>(problem.node_forces.cols()), 0),
        gradient_(3, problem.node_forces.cols()),
        trial_gradient_(3, problem.node_forces.cols()) {
    for (const HeldPoint& held : problem.held) index_[static_cast<std::size_t>(held.point)] = -1;
    for (Eigen::Index& index : index_) {
      if (index == 0) index = free_++;
    }
  }

  /// Takes Newton steps until they are below `tolerance` polygon lengths.
  SolveStatus run(double tolerance) {
    tolerance_ = tolerance;
    iteration_ = {};
    energy_ = polygon_energy(problem_, result_.points, gradient_);
    ++result_.evaluations;
    if (free_ == 0) return SolveStatus::converged;
    assemble(HessianTerms::all);
    while (result_.evaluations < options_.max_evaluations) {
      if (deadline_.passed()) return SolveStatus::time_limit;
      if (const std::optional<SolveStatus> end = advance()) return *end;
    }
    return SolveStatus::evaluation_limit;
  }

  /// Evaluates the returned points anew, and revokes a success that they do not prove. Three
  /// conditions are required: the Hessian is positive definite, Newton's step is of the size of
  /// rounding, and the residual force on each free point is negligible against the forces that act.
  /// (A step below the tolerance may leave a larger residual, because segments are stiff. Up to
  /// three further steps are then taken.)
  void verify_result() {
    constexpr int most_steps = 3;
    for (int taken = 0;; ++taken) {
      const double acting = evaluate();
      if (!succeeded(result_.status) || free_ == 0) return;
      assemble(HessianTerms::all);
      if (!factor(0)) return revoke_success("the Hessian is not positive definite");
      const Eigen::VectorXd step = solver_.solve(free_part(-gradient_));
      const double size = step.norm() / std::sqrt(static_cast<double>(free_)) / length_;
      const double rounding = 16 * epsilon * largest_ * result_.points.cwiseAbs().maxCoeff();
      std::ostringstream why;
      if (!(size <= rounding_step)) {
        why << "the Newton step is " << size << " of the length";
        return revoke_success(why.str());
      }
      if (result_.residual <= std::max(rounding, largest_residual_force * acting)) return;
      if (taken == most_steps) {
        why << "the largest residual force on a point is " << result_.residual
            << " N, with acting forces of " << acting << " N";
        return revoke_success(why.str());
      }
      result_.points = moved(step);
      count_twists();
    }
  }

 private:
  // First and largest damping, divided by the largest diagonal element of the Hessian.
  static constexpr double first_damping = 1e-12;
  static constexpr double most_damping = 1e3;

  /// State of the iteration of one run().
  struct IterationState {
    double damping = 0;
    double last_step = std::numeric_limits<double>::infinity();
    double last_incomplete_step = 0;
    double saddle_step = first_escape_step;
    int slow_steps = 0;  // consecutive steps with an incomplete Hessian that became shorter
    int escapes = 0;
  };

  /// Takes one step of run(). @return the final status; std::nullopt if the iteration continues
  [[nodiscard]] std::optional<SolveStatus> advance() {
    const bool exact = hessian_terms_ == HessianTerms::all;
    if (!factor(iteration_.damping)) {
      if (!exact || !options_.project_hessian) return increase_damping();
      assemble(HessianTerms::positive_terms);
      return std::nullopt;
    }
    const Eigen::VectorXd force = free_part(-gradient_);
    Eigen::VectorXd step = solver_.solve(force);
    const double size = step.norm() / std::sqrt(static_cast<double>(free_)) / length_;
    if (!std::isfinite(size)) return SolveStatus::failed;
    if (iteration_.damping == 0 && exact) {
      if (size <= tolerance_) return SolveStatus::converged;
      if (size < rounding_step && size > iteration_.last_step / 2)
        return SolveStatus::roundoff_limited;
      iteration_.last_step = size;
      iteration_.slow_steps = 0;
    } else if (const bool at_rest = force.dot(step) <= rounding_energy();
               at_rest || (size < iteration_.saddle_step && iteration_.slow_steps >= 3)) {
      // The polygon is in equilibrium, or approaches it slowly, but only omitted terms or damping
      // made the Hessian positive.
      iteration_.saddle_step = size / 4;
      iteration_.slow_steps = 0;
      return leave_saddle(at_rest);
    }
    step *= std::min(1.0, largest_step * length_ / step.cwiseAbs().maxCoeff());
    return try_step(step, size);
  }

  /// Leaves a saddle along the lowest mode. If the polygon is at rest and the exact Hessian is
  /// positive, the iteration only continues without damping. Returns std::nullopt if the iteration
  /// continues, `saddle` after too many attempts, and `failed` if no damping suffices.
  [[nodiscard]] std::optional<SolveStatus> leave_saddle(bool at_rest) {
    assemble(HessianTerms::all);
    if (at_rest && factor(0)) {
      iteration_.damping = 0;
      return std::nullopt;
    }
    if (at_rest && iteration_.escapes++ == 10) return SolveStatus::saddle;
    iteration_.damping = std::max(iteration_.damping, first_damping);
    for (; !factor(iteration_.damping); iteration_.damping *= 4) {
      if (iteration_.damping > most_damping) return SolveStatus::failed;
    }
    move_along_lowest_mode();
    assemble(HessianTerms::all);
    return std::nullopt;
  }

  /// Takes a step if it does not increase the energy; otherwise makes the next step shorter.
  [[nodiscard]] std::optional<SolveStatus> try_step(const Eigen::VectorXd& step, double size) {
    const bool exact = hessian_terms_ == HessianTerms::all;
    const Eigen::Matrix3Xd trial = moved(step);
    const double trial_energy = polygon_energy(problem_, trial, trial_gradient_);
    ++result_.evaluations;
    if (trial_energy < energy_ + rounding_energy() && trial_gradient_.allFinite()) {
      result_.points = trial;
      count_twists();
      gradient_ = trial_gradient_;
      energy_ = trial_energy;
      assemble(HessianTerms::all);
      iteration_.damping = iteration_.damping < 4 * first_damping ? 0 : iteration_.damping / 8;
      const bool slow = !exact && size < std::exchange(iteration_.last_incomplete_step, size);
      iteration_.slow_steps = slow ? iteration_.slow_steps + 1 : 0;
    } else if (exact && iteration_.damping == 0 && options_.project_hessian) {
      assemble(HessianTerms::positive_terms);
    } else {
      return increase_damping();
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<SolveStatus> increase_damping() {
    iteration_.damping = std::max(4 * iteration_.damping, first_damping);
    if (iteration_.damping > most_damping) return SolveStatus::failed;
    return std::nullopt;
  }

  /// Evaluates energy, gradient and residual of the points. @return scale of the forces that act
  /// [N]: the sum of the sizes of all node forces, or the largest force on a held point if that is
  /// larger
  double evaluate() {
    result_.energy = energy_ = polygon_energy(problem_, result_.points, gradient_);
    ++result_.evaluations;
    result_.residual = 0;
    double acting = problem_.node_forces.colwise().norm().sum();
    for (Eigen::Index i = 0; i < gradient_.cols(); ++i) {
      const bool held = index_[static_cast<std::size_t>(i)] < 0;
      double& largest = held ? acting : result_.residual;
      largest = std::max(largest, gradient_.col(i).norm());
    }
    return acting;
  }

  void revoke_success(const std::string& why) {
    result_.status = SolveStatus::not_verified;
    result_.message = std::string(to_string(result_.status)) + ": " + why;
  }

  [[nodiscard]] double rounding_energy() const {
    const Eigen::Vector3d first = problem_.held.front().position;
    const Eigen::Matrix3Xd arms = result_.points.colwise() - first;
    const double work = problem_.node_forces.cwiseAbs().cwiseProduct(arms.cwiseAbs()).sum();
    const double forces = problem_.node_forces.colwise().norm().sum();
    return 16 * epsilon * (std::abs(energy_) + work + first.norm() * forces);
  }

  void count_twists() {
    for (PolygonTwist& twist : problem_.twists) {
      twist.angle = polygon_twist_angle(twist, result_.points);
    }
  }

  void assemble(HessianTerms which) {
    hessian_terms_ = which;
    // A joint couples three points.
    const Eigen::Index unknowns = axes_ * free_;
    hessian_.setZero(std::min(3 * axes_, unknowns), unknowns);
    polygon_hessian(problem_, result_.points, which,
                    [&](Eigen::Index row, Eigen::Index column, const Eigen::Matrix3d& block) {
                      const Eigen::Index r = index_[static_cast<std::size_t>(row)];
                      const Eigen::Index c = index_[static_cast<std::size_t>(column)];
                      if (r < 0 || c < 0 || r < c) return;
                      for (Eigen::Index j = 0; j < axes_; ++j) {
                        for (Eigen::Index i = r == c ? j : 0; i < axes_; ++i) {
                          hessian_(axes_ * (r - c) + i - j, axes_ * c + j) += block(i, j);
                        }
                      }
                    });
    largest_ = hessian_.row(0).cwiseAbs().maxCoeff();
    columns_.resize(axes_ * free_, static_cast<Eigen::Index>(problem_.twists.size()));
    if (columns_.cols() == 0) return;
    const Eigen::MatrixXd of_all = twist_columns(problem_, result_.points);
    for (std::size_t i = 0; i < index_.size(); ++i) {
      if (index_[i] < 0) continue;
      columns_.middleRows(3 * index_[i], 3) =
          of_all.middleRows(3 * static_cast<Eigen::Index>(i), 3);
    }
    largest_ = std::max(largest_, columns_.colwise().squaredNorm().maxCoeff());
  }

  /// Factorises the Hessian. @return whether the Hessian plus damping is positive definite, to
  /// rounding
  bool factor(double damping) {
    return solver_.compute(hessian_, columns_, (damping + 64 * epsilon) * largest_);
  }

  [[nodiscard]] Eigen::VectorXd free_part(const Eigen::Matrix3Xd& vectors) const {
    Eigen::VectorXd result(axes_ * free_);
    for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
      const Eigen::Index k = index_[static_cast<std::size_t>(i)];
      if (k >= 0) result.segment(axes_ * k, axes_) = vectors.col(i).head(axes_);
    }
    return result;
  }

  [[nodiscard]] Eigen::Matrix3Xd moved(const Eigen::VectorXd& step) const {
    Eigen::Matrix3Xd points = result_.points;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Eigen::Index k = index_[static_cast<std::size_t>(i)];
      if (k >= 0) points.col(i).head(axes_) += step.segment(axes_ * k, axes_);
    }
    return points;
  }

  /// Leaves a saddle along the direction of its lowest curvature, found by inverse iteration with
  /// the damped factor.
  void move_along_lowest_mode() {
    Eigen::VectorXd direction(axes_ * free_);
    for (Eigen::Index i = 0; i < direction.size(); ++i) {
      direction[i] = 1 + std::sin(static_cast<double>(i));  // a vector without symmetry
    }
    for (int i = 0; i < 20; ++i) direction = solver_.solve(direction).normalized();
    direction *= 1e-3 * length_ / direction.cwiseAbs().maxCoeff();
    const Eigen::Matrix3Xd forward = moved(direction);
    const Eigen::Matrix3Xd back = moved(-direction);
    const double forward_energy = polygon_energy(problem_, forward, trial_gradient_);
    const bool better = forward_energy <= polygon_energy(problem_, back, gradient_);
    result_.points = better ? forward : back;
    count_twists();
    energy_ = polygon_energy(problem_, result_.points, gradient_);
    result_.evaluations += 3;
  }

  PolygonProblem& problem_;
  const PolygonOptions& options_;
  const Deadline& deadline_;
  PolygonResult& result_;
  double length_;
  // Coordinates in which free points move: x and y with natural turns, else all three.
  Eigen::Index axes_;
  double tolerance_ = 0;
  IterationState iteration_;
  std::vector<Eigen::Index> index_;  // index of each point among the free ones; -1 for held points
  Eigen::Index free_ = 0;
  double energy_ = 0;
  double largest_ = 0;
  Eigen::Matrix3Xd gradient_;
  Eigen::Matrix3Xd trial_gradient_;
  HessianTerms hessian_terms_ = HessianTerms::all;  // terms that hessian_ contains
  Eigen::MatrixXd hessian_;  // Hessian of the free points, banded: see PolygonFactor
  Eigen::MatrixXd columns_;  // twist_columns() of the free points
  PolygonFactor solver_;
};

/// Returns the stretch stiffness of the first stage.
double first_stretch_stiffness(const PolygonProblem& problem, const Eigen::Matrix3Xd& start) {
  PolygonProblem bending = problem;
  bending.node_forces.setZero();
  bending.obstacles.clear();
  // Without stretch the energy is that of the bent joints and twists.
  bending.stretch_stiffness = 0;
  Eigen::Matrix3Xd unused(3, start.cols());
  const double force = polygon_energy(bending, start, unused) / problem.rest_lengths.sum() +
                       problem.node_forces.colwise().norm().sum();
  return std::clamp(force / soft_strain, 1e-9 * problem.stretch_stiffness,
                    problem.stretch_stiffness);
}

}  // namespace

PolygonResult solve_polygon(const PolygonProblem& problem, const Points& start,
                            const PolygonOptions& options) {
  const Deadline deadline(options.time_limit);
  require_polygon(problem, start, options);
  PolygonResult result;
  result.points = start;
  for (const HeldPoint& held : problem.held) result.points.col(held.point) = held.position;

  PolygonProblem stage = problem;
  const double shortest = problem.rest_lengths.minCoeff();
  const double first = options.in_stages ? first_stretch_stiffness(problem, result.points)
                                         : problem.stretch_stiffness;
  for (double c_c = first;; c_c *= 10) {
    const bool last = c_c >= problem.stretch_stiffness;
    stage.stretch_stiffness = last ? problem.stretch_stiffness : c_c;
    for (std::size_t i = 0; i < problem.obstacles.size(); ++i) {
      const double most = last ? std::numeric_limits<double>::infinity() : c_c / shortest;
      stage.obstacles[i].stiffness = std::min(problem.obstacles[i].stiffness, most);
      stage.obstacles[i].stiffnesses = problem.obstacles[i].stiffnesses.cwiseMin(most);
    }
    PolygonDescent descent(stage, options, deadline, result);
    result.status = descent.run(last ? options.tolerance : stage_tolerance);
    result.message = to_string(result.status);
    const bool go_on = succeeded(result.status) || result.status == SolveStatus::saddle;
    if (last || !go_on) break;
  }
  // A softer stage may have failed; the result has to be evaluated for the problem itself.
  stage.stretch_stiffness = problem.stretch_stiffness;
  stage.obstacles = problem.obstacles;
  PolygonDescent(stage, options, deadline, result).verify_result();
  for (const PolygonTwist& twist : stage.twists) {
    result.twists.push_back(polygon_twist_angle(twist, result.points));
  }
  result.grip_forces.resize(3, static_cast<Eigen::Index>(problem.held.size()));
  stage.obstacles.clear();
  Eigen::Matrix3Xd gradient(3, result.points.cols());
  (void)polygon_energy(stage, result.points, gradient);
  for (std::size_t i = 0; i < problem.held.size(); ++i) {
    result.grip_forces.col(static_cast<Eigen::Index>(i)) = gradient.col(problem.held[i].point);
  }
  result.seconds = deadline.spent();
  return result;
}

}  // namespace dlo::energy_model
