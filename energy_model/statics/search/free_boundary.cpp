#include "search/free_boundary.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "contact/clearance.hpp"

namespace dlo::energy_model {
namespace {

bool is_free(const Span& span, double at) {
  return at > closest_cuts && at < span.length - closest_cuts && !is_held(span, at);
}

constexpr int most_boundary_steps = 25;
/// Number of Broyden updates between two evaluations of the derivatives.
constexpr int updates_per_derivative = 8;
/// Maximum number of times that a step without an equilibrium is divided by 4.
constexpr int most_step_divisions = 3;
/// Step of the ends, divided by the span's length, below which they have converged.
constexpr double converged_step = 1e-10;
/// Largest residual (in the measures of free_boundary.hpp, which are at least the step) that counts
/// as zero. A remaining curvature at a lift-off is a moment there. The contact has to balance it
/// next to that end, and its series of K coefficients has a force K^2 times as large at the end.
constexpr double zero_residual = 1e-12;
/// Residual below which steps that do not halve it count as rounding.
constexpr double small_residual = 1e-10;
/// Longest step, divided by the span's length (the polygon has already located the ends), and
/// divided by the free distance on that side.
constexpr double longest_step = 0.02;
constexpr double largest_room_share = 0.45;
/// Step of the finite differences, divided by the free distance.
constexpr double finite_difference_step = 1e-6;

class FreeBoundaryNewton {
 public:
  FreeBoundaryNewton(SpanSolution& solution, const Deadline& deadline, SpanWorkspace& workspace)
      : solution_(solution),
        deadline_(deadline),
        workspace_(workspace),
        factor_(solution.factor),
        ends_(free_boundaries(solution.model->span())),
        residual_(free_boundary_residual(solution, ends_)),
        jacobian_(residual_.size(), residual_.size()),
        x_by_ends_(solution.x.size(), residual_.size()),
        multipliers_by_ends_(solution.multipliers.size(), residual_.size()) {}

  int run() {
    if (ends_.empty()) return spent_;
    double before = INFINITY;
    for (int step = 0; step < most_boundary_steps && !deadline_.passed(); ++step) {
      const double size = residual_.cwiseAbs().maxCoeff();
      if (size < zero_residual) break;
      if (size < small_residual && size > before / 2) break;
      before = size;
      if (step % updates_per_derivative == 0 && !differentiate()) break;
      Eigen::VectorXd displacement = limit_step(-jacobian_.partialPivLu().solve(residual_));
      if (!displacement.allFinite() || !move(displacement)) break;
      if (displacement.cwiseAbs().maxCoeff() < converged_step * solution_.model->span().length)
        break;
    }
    return spent_;
  }

 private:
  [[nodiscard]] Eigen::VectorXd limit_step(Eigen::VectorXd displacement) const {
    const Span& span = solution_.model->span();
    double share = 1;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const double size = std::abs(displacement[static_cast<Eigen::Index>(i)]);
      const MoveLimits limits = move_limits(span, ends_[i]);
      const bool down = displacement[static_cast<Eigen::Index>(i)] < 0;
      const double most = std::min(largest_room_share * (down ? limits.down : limits.up),
                                   longest_step * span.length);
      if (size > most) share = std::min(share, most / size);
    }
    displacement *= share;
    return displacement;
  }

  /// Solves for the equilibrium with moved ends, starting from its first-order prediction.
  [[nodiscard]] SpanSolution solve_with_moved_ends(const Eigen::VectorXd& displacement,
                                                   NewtonMethod method) {
    Span span = solution_.model->span();
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      ends_[i].move(span, displacement[static_cast<Eigen::Index>(i)]);
    }
    SpanSolution result = workspace_.empty_solution(span, solution_.terms);
    NewtonOptions options = {.deadline = deadline_};
    if (result.model->elements() == solution_.model->elements()) {
      result.x = result.model->prolong(*solution_.model, solution_.x);
      result.x += x_by_ends_ * displacement;
      result.multipliers = solution_.multipliers + multipliers_by_ends_ * displacement;
      options.method = method;
      if (method == NewtonMethod::simplified) options.first_factor = factor_;
    } else {
      const TangentField near = solution_.model->field(solution_.x);
      result.x = result.model->fit(near(result.model->nodes()));
    }
    newton_solve(result, options, workspace_.newton());
    if (result.factor) factor_ = result.factor;
    spent_ += std::exchange(result.evaluations, 0);
    return result;
  }

  /// Moves the free ends of contact and solves for the equilibrium there.
  /// @param[in,out] displacement  of the ends; shortened if it leads to no equilibrium
  /// @return whether an equilibrium was found
  [[nodiscard]] bool move(Eigen::VectorXd& displacement) {
    const Eigen::VectorXd whole = displacement;
    SpanSolution trial;
    for (const NewtonMethod method : {NewtonMethod::simplified, NewtonMethod::newton}) {
      displacement = whole;
      trial = solve_with_moved_ends(displacement, method);
      for (int cut = 0; cut < most_step_divisions && !trial.is_equilibrium(); ++cut) {
        displacement /= 4;
        trial = solve_with_moved_ends(displacement, method);
      }
      if (trial.is_equilibrium()) break;
    }
    if (!trial.is_equilibrium()) return false;
    const Eigen::VectorXd residual = free_boundary_residual(trial, ends_);
    const Eigen::RowVectorXd along = displacement.transpose() / displacement.squaredNorm();
    jacobian_ += (residual - residual_ - jacobian_ * displacement) * along;
    if (has_same_unknowns(trial)) {
      x_by_ends_ += (trial.x - solution_.x - x_by_ends_ * displacement) * along;
      multipliers_by_ends_ +=
          (trial.multipliers - solution_.multipliers - multipliers_by_ends_ * displacement) * along;
    } else {
      x_by_ends_.setZero(trial.x.size(), residual_.size());
      multipliers_by_ends_.setZero(trial.multipliers.size(), residual_.size());
    }
    residual_ = residual;
    solution_ = std::move(trial);
    return true;
  }

  /// Whether a solution has as many unknowns; the number of elements may change with their lengths.
  [[nodiscard]] bool has_same_unknowns(const SpanSolution& other) const {
    return other.x.size() == solution_.x.size() &&
           other.multipliers.size() == solution_.multipliers.size();
  }

  [[nodiscard]] bool differentiate() {
    Eigen::VectorXd displacement = Eigen::VectorXd::Zero(residual_.size());
    x_by_ends_.setZero(solution_.x.size(), residual_.size());
    multipliers_by_ends_.setZero(solution_.multipliers.size(), residual_.size());
    for (Eigen::Index i = 0; i < residual_.size(); ++i) {
      const FreeBoundary& end = ends_[static_cast<std::size_t>(i)];
      const Span::Contact& contact = solution_.model->span().contacts[end.contact];
      if (!contact.lies() && contact.slides) {
        // A sliding contact point does not depend on where its search begins.
        jacobian_.col(i) = Eigen::VectorXd::Unit(residual_.size(), i);
        continue;
      }
      const MoveLimits limits = move_limits(solution_.model->span(), end);
      displacement[i] =
          finite_difference_step * (limits.down > limits.up ? -limits.down : limits.up);
      SpanSolution perturbed = solve_with_moved_ends(displacement, NewtonMethod::simplified);
      if (!perturbed.is_equilibrium())
        perturbed = solve_with_moved_ends(displacement, NewtonMethod::newton);
      if (!perturbed.is_equilibrium()) return false;
      jacobian_.col(i) = (free_boundary_residual(perturbed, ends_) - residual_) / displacement[i];
      if (has_same_unknowns(perturbed)) {
        x_by_ends_.col(i) = (perturbed.x - solution_.x) / displacement[i];
        multipliers_by_ends_.col(i) =
            (perturbed.multipliers - solution_.multipliers) / displacement[i];
      }
      displacement[i] = 0;
    }
    return true;
  }

  SpanSolution& solution_;
  const Deadline& deadline_;
  SpanWorkspace& workspace_;
  // Factor of the previous step, reused for nearly the same ends
  std::shared_ptr<NewtonFactor> factor_;
  std::vector<FreeBoundary> ends_;
  Eigen::VectorXd residual_;
  // Derivatives by the ends: of the residual, and of an equilibrium's unknowns and multipliers.
  Eigen::MatrixXd jacobian_, x_by_ends_, multipliers_by_ends_;
  int spent_ = 0;
};

}  // namespace

double FreeBoundary::at(const Span& span) const {
  const Span::Contact& own = span.contacts[contact];
  return begins ? own.begin : own.end;
}

void FreeBoundary::move(Span& span, double displacement) const {
  Span::Contact& own = span.contacts[contact];
  const bool lies = own.lies();
  if (begins || !lies) own.begin += displacement;
  if (!begins || !lies) own.end += displacement;
  if (!lies) own.end = own.begin;
}

std::vector<FreeBoundary> free_boundaries(const Span& span) {
  std::vector<FreeBoundary> ends;
  for (std::size_t i = 0; i < span.contacts.size(); ++i) {
    const Span::Contact& contact = span.contacts[i];
    if (is_free(span, contact.begin)) ends.push_back({i, true});
    if (contact.lies() && is_free(span, contact.end)) ends.push_back({i, false});
  }
  return ends;
}

MoveLimits move_limits(const Span& span, const FreeBoundary& end) {
  const double at = end.at(span);
  const Span::Contact& own = span.contacts[end.contact];
  MoveLimits limits{at, span.length - at};
  const auto avoid = [&](double other) {
    if (other < at) limits.down = std::min(limits.down, at - other);
    if (other > at) limits.up = std::min(limits.up, other - at);
  };
  avoid(span.anchor);
  for (const Span::Hold& hold : span.holds) avoid(hold.at);
  for (const Span::Contact& contact : span.contacts) {
    if (&contact == &own) continue;
    avoid(contact.begin);
    avoid(contact.end);
  }
  if (own.lies()) avoid(end.begins ? own.end : own.begin);
  return limits;
}

Eigen::VectorXd free_boundary_residual(const SpanSolution& solution,
                                       const std::vector<FreeBoundary>& ends) {
  constexpr double offset = 1e-12;
  const Span& span = solution.model->span();
  const std::shared_ptr<SpanPoint> point = solution.at_x();
  std::vector<double> s;
  for (const FreeBoundary& end : ends) {
    // Evaluate in the free one of the two elements that meet there.
    const double at = end.at(span);
    const bool after = span.contacts[end.contact].lies() && !end.begins;
    s.push_back(after ? at + offset : at - offset);
  }
  const Samples samples = solution.model->shape(solution.x).sample(s);
  Eigen::VectorXd result(static_cast<Eigen::Index>(ends.size()));
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Span::Contact& contact = span.contacts[ends[i].contact];
    const Clearance here = clearance_at(contact.obstacle.body, samples, column);
    const MoveLimits limits = move_limits(span, ends[i]);
    if (contact.lies()) {
      result[column] = here.rate * (ends[i].begins ? limits.down : limits.up);
    } else if (const auto at = solution.model->contact_arc_length(*point, ends[i].contact)) {
      result[column] = contact.begin - *at;
    } else {
      result[column] = here.slope * std::min(limits.down, limits.up);
    }
  }
  return result;
}

int free_boundary_newton(SpanSolution& solution, const Deadline& deadline,
                         SpanWorkspace& workspace) {
  return FreeBoundaryNewton(solution, deadline, workspace).run();
}

}  // namespace dlo::energy_model
