#include "search/twist_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "base/legendre.hpp"
#include "base/spin.hpp"
#include "certify/piece_cuts.hpp"
#include "linear/reduced_hessian.hpp"
#include "newton/trust_region.hpp"
#include "search/active_set.hpp"
#include "span/found.hpp"
#include "span/refinement.hpp"
#include "strain/second_derivatives.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// Longest continuation step, which is also the first one, and the shortest: rotation of the end
/// [rad].
constexpr double longest_rotation_step = 1.6;
constexpr double least_rotation = 1e-4;
/// Largest step after which a shape that has become unstable is accepted, to start a descent from
/// it [rad].
constexpr double rotation_at_stability_loss = 0.02;

/// Largest difference between the change of energy in a step and the torque's work on the same
/// branch, divided by twice the twist energy of a straight rod rotated by the step.
constexpr double branch_energy_tolerance = 0.05;
/// Largest such difference after which the next step may be longer.
constexpr double smooth_energy_tolerance = 0.005;

/// Eigenvalue, divided by the forces, below which rounding alone would move a shape visibly.
constexpr double rounding_eigenvalue = 1e-9;

/// Distance of unknowns up to which a factor determines the stability of a stiff shape, and
/// smallest eigenvalue of a stiff shape.
constexpr double nearest_factor = 1e-3;
constexpr double least_stiff_eigenvalue = 1e-2;

/// Maximum number of branch jumps; without a limit each could lead to the next.
constexpr int most_branch_jumps = 60;

/// First displacement along the unstable direction, and number of displacements that are tried.
constexpr double first_displacement = 0.1;
constexpr int most_displacements = 4;

/// Truncation tolerances of a path, in rod lengths: coefficients that contribute less to positions
/// are added only at the end. The second value is used if the path with the first one fails.
constexpr double coarse_tolerance = 1e-5;
constexpr double fine_tolerance = 1e-6;

constexpr int least_path_terms = 8;

/// Returns the angle about `axis` from a to the component of b normal to it, in (-pi, pi].
double angle_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& a,
                   const Eigen::Vector3d& b) {
  return wrap_to_pi(std::atan2(axis.dot(a.cross(b)), a.dot(b) - axis.dot(a) * axis.dot(b)));
}

class TwistPath {
 public:
  /// @param tolerance  coefficients that contribute less to positions [l] are omitted
  TwistPath(const Span& span, double stiffness, const UntwistedShape& untwisted,
            const SpanOptions& options, double tolerance, SpanWorkspace& workspace)
      : span_(in_space(span)),
        options_(options),
        workspace_(workspace),
        active_set_(span_, options, workspace),
        tolerance_(tolerance),
        first_d1_(untwisted.end_d1) {
    Span twisted = in_space(untwisted.solution.model->span());
    twisted.twist = Span::Twist{stiffness, first_d1_};
    here_ = workspace.empty_solution(twisted, terms_of(untwisted.solution));
    here_.x = here_.model->prolong(*untwisted.solution.model, untwisted.solution.x);
  }

  [[nodiscard]] SpanSolution run(double whole) {
    newton(here_, NewtonMethod::corrector);
    if (here_.is_equilibrium()) is_far_from_singular_ = is_stable(here_) && is_far_from_singular_;
    double turn = std::copysign(longest_rotation_step, whole);
    while (here_.is_equilibrium() && angle_ != whole) {
      if (options_.deadline.passed()) {
        here_.finish(SolveStatus::time_limit);
        break;
      }
      const bool last = std::abs(whole - angle_) < 1.001 * std::abs(turn);
      const double angle = last ? whole : angle_ + turn;
      turn = angle - angle_;
      std::optional<SpanSolution> next = continuation_step(turn);
      const bool stable = next && is_stable(*next);
      if (next && (stable || std::abs(turn) <= rotation_at_stability_loss)) {
        accept(std::move(*next), angle);
        const bool finer = resolve();
        if (!(finer ? is_stable(here_) : stable)) leave_unstable_shape();
        if (may_lengthen_step_) turn *= 1.5;
        turn = std::clamp(turn, -longest_rotation_step, longest_rotation_step);
      } else if (std::abs(turn) > least_rotation) {
        turn /= 3;
      } else {
        // The branch ends here.
        angle_ += turn;
        rotate_clamp(here_, angle_);
        leave_unstable_shape();
        turn = std::copysign(rotation_at_stability_loss, whole);
      }
    }
    here_.evaluations = spent_;
    if (here_.status != SolveStatus::time_limit && angle_ != whole) {
      here_.fail("the rod could not be followed beyond a twist of " + std::to_string(angle_) +
                 " rad");
    }
    return std::move(here_);
  }

 private:
  [[nodiscard]] static Span in_space(Span span) {
    span.planar = false;
    return span;
  }

  /// Returns the number of a shape's coefficients that are kept.
  [[nodiscard]] int terms_of(const SpanSolution& solution) const {
    if (options_.terms > 0) return solution.terms;
    return terms_needed(*solution.model, solution.x, tolerance_, least_path_terms);
  }

  /// Rotates the end's clamp by an angle relative to the untwisted rod's end frame.
  void rotate_clamp(SpanSolution& solution, double angle) const {
    const Eigen::AngleAxisd about(angle, *span_.end_direction);
    solution.model->turn_end_clamp(about * first_d1_);
  }

  /// Solves for the equilibrium near the extrapolation of the last two; std::nullopt if none is
  /// found, or if it is not on the same branch.
  [[nodiscard]] std::optional<SpanSolution> continuation_step(double turn) {
    SpanSolution next = here_;
    rotate_clamp(next, angle_ + turn);
    next.evaluations = 0;
    if (slope_x_.size() == here_.x.size()) {
      next.x += turn * slope_x_;
      next.multipliers += turn * slope_multipliers_;
    } else {
      next.x = next.model->with_twist(next.x, next.model->twist(next.x) + turn);
    }
    const Eigen::VectorXd predicted = next.x;
    // If no eigenvalue is near zero, the factor from the last stability test is reused.
    newton(next, is_far_from_singular_ ? NewtonMethod::simplified : NewtonMethod::corrector);
    next = update_contacts_of(std::move(next));
    spent_ += std::exchange(next.evaluations, 0);
    if (!next.is_equilibrium()) return std::nullopt;
    // On the same branch the energy changes by the torque's work. The shape is no criterion: it may
    // rotate about a line without a change of energy.
    const double work = (torque(here_) + torque(next)) / 2 * turn;
    const double unit = here_.model->span().twist->stiffness / span_.length * turn * turn;
    const double rounding = 1e-9 * (1 + next.model->load() + std::abs(next.energy));
    const double jump = std::abs(next.energy - here_.energy - work);
    if (!(jump <= branch_energy_tolerance * unit + rounding)) return std::nullopt;
    may_lengthen_step_ = jump <= smooth_energy_tolerance * unit + rounding;
    has_deviated_ = next.x.size() != predicted.size() ||
                    (next.x - predicted).norm() > (predicted - here_.x).norm();
    return next;
  }

  /// Updates the contacts of an equilibrium that may be within rigid obstacles or be pulled by
  /// them.
  [[nodiscard]] SpanSolution update_contacts_of(SpanSolution solution) {
    if (span_.rigid_obstacles.empty() || !solution.is_equilibrium()) return solution;
    return active_set_.update(std::move(solution));
  }

  /// Runs Newton's method. @param how  simplified: uses the solution's own factor
  void newton(SpanSolution& solution, NewtonMethod how) {
    newton_solve(solution,
                 {.method = how,
                  .first_factor = how == NewtonMethod::simplified ? solution.factor : nullptr,
                  .deadline = options_.deadline},
                 workspace_.newton());
  }

  [[nodiscard]] static double torque(const SpanSolution& solution) {
    return solution.model->twisting_torque(solution.x, solution.multipliers);
  }

  void accept(SpanSolution next, double angle) {
    const double turn = angle - angle_;
    slope_x_.resize(0);
    last_step_.resize(0);
    if (next.x.size() == here_.x.size()) last_step_ = next.x - here_.x;
    if (!has_deviated_) {
      slope_x_ = last_step_ / turn;
      slope_multipliers_ = (next.multipliers - here_.multipliers) / turn;
    }
    here_ = std::move(next);
    angle_ = angle;
  }

  /// Adds coefficients if the shape needs them. @return whether any were added
  bool resolve() {
    const bool affordable = here_.terms < max_terms && here_.model->size() * 5 / 4 < most_unknowns;
    const bool resolved =
        here_.model->truncation(here_.x) < allowed_truncation(tolerance_, here_.terms) &&
        here_.terms >= terms_for_buckling_modes(here_);
    if (resolved || !affordable) return false;
    here_ = workspace_.with_terms(here_,
                                  std::min(max_terms, here_.terms + std::max(2, here_.terms / 4)));
    newton(here_, NewtonMethod::corrector);
    spent_ += std::exchange(here_.evaluations, 0);
    slope_x_.resize(0);
    last_step_.resize(0);
    return true;
  }

  [[nodiscard]] bool is_stable(SpanSolution& solution) {
    is_far_from_singular_ = false;
    if (!(distance_of_factor(solution) <= nearest_factor)) factor_at(solution);
    ReducedHessian& near = solution.factor->system.reduced_hessian();
    if (near.has_solutions()) {
      const std::optional<double> smallest = near.smallest_eigenvalue_of_definite();
      is_far_from_singular_ = smallest && *smallest > least_stiff_eigenvalue;
      if (is_far_from_singular_) return true;
    }
    if (distance_of_factor(solution) > 0) factor_at(solution);
    Eigen::MatrixXd projected = solution.factor->system.reduced_hessian().matrix();
    // Under large forces the sign of an eigenvalue near zero is lost in rounding.
    projected.diagonal().array() += rounding_eigenvalue * solution.multipliers.norm();
    return is_minimum(projected);
  }

  /// Returns the distance of the solution from the point of its factor; infinity if there is no
  /// factor.
  [[nodiscard]] static double distance_of_factor(const SpanSolution& solution) {
    return solution.factor ? solution.factor->distance(solution)
                           : std::numeric_limits<double>::infinity();
  }

  void factor_at(SpanSolution& solution) {
    workspace_.newton().factor_at(solution, *solution.at_x());
  }

  /// Descends from a displaced shape to a stable one.
  void leave_unstable_shape() {
    if (++branch_jumps_ > most_branch_jumps)
      return here_.fail("the rod jumps from branch to branch");
    std::optional<SpanSolution> next = descend_from(here_);
    // A stable shape far away may need more coefficients than the branch that ends here.
    SpanSolution finer = here_;
    while (!next && finer.terms < max_terms && 2 * finer.model->size() < most_unknowns &&
           !options_.deadline.passed()) {
      finer = workspace_.with_terms(finer, std::min(max_terms, 2 * finer.terms));
      next = descend_from(finer);
    }
    if (!next) {
      return here_.fail("nothing stable was found below a twist of " + std::to_string(angle_) +
                        " rad");
    }
    here_ = std::move(*next);
    slope_x_.resize(0);
    last_step_.resize(0);
  }

  /// Displaces an unstable shape along a direction of negative curvature and descends. @return a
  /// stable equilibrium; std::nullopt if none is found
  [[nodiscard]] std::optional<SpanSolution> descend_from(const SpanSolution& from) {
    ReducedHessian reduced = reduced_hessian(second_derivatives(from));
    std::optional<Eigen::VectorXd> direction = negative_curvature_direction(reduced);
    // Near a fold the shape moves along the unstable direction, as in the last step.
    if (!direction && last_step_.size() == from.x.size() && last_step_.norm() > 0) {
      direction = last_step_.normalized();
    }
    if (!direction) direction = eigenvector_by_magnitude(reduced, 0);
    double push = first_displacement;
    for (int i = 0; i < 2 * most_displacements; ++i) {
      SpanSolution next = from;
      next.evaluations = 0;
      if (direction) next.x += push * *direction;
      if (i % 2 == 0) {
        descend_by_augmented_lagrangian(next, {.deadline = options_.deadline});
      } else {
        descend_in_trust_region(next, {.deadline = options_.deadline});
        push *= 3;
      }
      if (succeeded(next.status)) newton(next, NewtonMethod::newton);
      next = update_contacts_of(std::move(next));
      spent_ += std::exchange(next.evaluations, 0);
      if (next.is_equilibrium() && is_stable(next)) return next;
    }
    return std::nullopt;
  }

  Span span_;  // without contacts and twist
  const SpanOptions& options_;
  SpanWorkspace& workspace_;
  ActiveSet active_set_;
  double tolerance_;
  Eigen::Vector3d first_d1_;  // d1 of the untwisted end
  SpanSolution here_;
  double angle_ = 0;
  int spent_ = 0;
  int branch_jumps_ = 0;
  bool may_lengthen_step_ = false;  // the last step was shorter than necessary
  bool has_deviated_ = false;       // the last step has deviated from its prediction
  Eigen::VectorXd last_step_;
  Eigen::VectorXd slope_x_, slope_multipliers_;  // derivatives by the angle; empty after a jump
  bool is_far_from_singular_ = false;  // no eigenvalue of the last tested shape is near zero
};

/// Refines a solution with all coefficients and certifies it. If the span has rigid obstacles, the
/// active set of contacts is solved too.
SpanSolution certified(SpanSolution solution, const SpanOptions& options,
                       SpanWorkspace& workspace) {
  Span span = solution.model->span();
  if (span.rigid_obstacles.empty()) return finish(std::move(solution), options, workspace);
  return ActiveSet(span, options, workspace).solve(std::move(solution));
}

}  // namespace

Eigen::Vector3d prescribed_end_d1(const HeldFrames& held, const Span& span) {
  const Eigen::Vector3d& start = *span.start_direction;
  const double frame_angle = angle_about(start, span.first_d1(start), held.start_d1);
  return Eigen::AngleAxisd(held.turns.roll - frame_angle, *span.end_direction) * held.end_d1;
}

UntwistedShape untwisted_shape(const SpanSolution& solution, SpanWorkspace& workspace) {
  Span span = solution.model->span();
  span.planar = false;
  const std::shared_ptr<SpanEnergy> model = workspace.model(span, solution.terms);
  const Eigen::VectorXd x = model->prolong(*solution.model, solution.x);
  return {solution, model->evaluated(x).end_d1(), model->twist(x), writhe_of(solution)};
}

EndFrame end_frame(const HeldFrames& held, const UntwistedShape& untwisted) {
  const Span& span = untwisted.solution.model->span();
  const Eigen::Vector3d& axis = *span.end_direction;
  const Eigen::Vector3d d1 = prescribed_end_d1(held, span);
  const double frame_angle = angle_about(axis, untwisted.end_d1, d1) - held.turns.roll;
  return {d1, end_rotation(held.turns, frame_angle, untwisted.twist, untwisted.writhe)};
}

SpanSolution twist_to(const EndFrame& frame, const Span& span, double stiffness,
                      const UntwistedShape& untwisted, const SpanOptions& options,
                      SpanWorkspace& workspace) {
  const double least = angle_about(*span.end_direction, untwisted.end_d1, frame.d1);
  const double angle = least + 2 * pi * std::round((frame.twist - least) / (2 * pi));
  SpanSolution solution;
  int spent = 0;
  for (const double tolerance : {coarse_tolerance, fine_tolerance}) {
    solution = TwistPath(span, stiffness, untwisted, options, tolerance, workspace).run(angle);
    if (solution.is_equilibrium()) solution = certified(std::move(solution), options, workspace);
    solution.evaluations += std::exchange(spent, spent + solution.evaluations);
    if (succeeded(solution.status) || options.deadline.passed()) break;
  }
  return solution;
}

SpanSolution twist_from(const TangentField& field, const EndFrame& frame, const Span& span,
                        double stiffness, const SpanOptions& options, SpanWorkspace& workspace) {
  Span twisted = span;
  twisted.planar = false;
  twisted.twist = Span::Twist{stiffness, frame.d1};
  SpanSolution solution;
  // The shape does not determine how many coefficients it needs.
  for (int terms = unknown_terms;; terms = std::min(max_terms, 3 * terms / 2)) {
    solution = workspace.empty_solution(twisted, terms);
    SpanEnergy& model = *solution.model;
    solution.x = model.with_twist(model.fit(field(model.nodes())), frame.twist);
    newton_solve(solution, {.deadline = options.deadline}, workspace.newton());
    const bool more = terms < max_terms && 3 * model.size() / 2 < most_unknowns;
    if (solution.is_equilibrium()) break;
    if (!more || options.deadline.passed()) return solution;
  }
  return certified(std::move(solution), options, workspace);
}

}  // namespace dlo::energy_model
