#include "search/settle_lift_offs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "contact/lift_off.hpp"

namespace dlo::energy_model {
namespace {

constexpr int most_steps = 25;
/// Broyden's updates until the derivatives are made anew.
constexpr int most_updates = 8;
/// Times that a step is cut to a quarter which leads to no equilibrium.
constexpr int most_cuts = 3;
/// Step at which an end is found, in lengths.
constexpr double settled = 1e-10;
/// What is missed where there is nothing to mend: lift_off.hpp's measures, which are steps or more.
/// A curvature that is left at a lift-off is a moment there. What the contact carries has to make
/// up for it next to that end, and its series of K terms ends with a force K^2 times as large.
constexpr double nothing_missed = 1e-12;
/// Below, steps that no longer halve what is missed are rounding.
constexpr double nearly_nothing_missed = 1e-10;
/// Longest step, in lengths: the polygon has told where the ends are; and over the room beside one.
constexpr double longest_step = 0.02;
constexpr double largest_share = 0.45;
/// Of a difference, over the room.
constexpr double difference = 1e-6;

class Settling {
 public:
  Settling(SpanSolution& solution, SpanWorkspace& workspace)
      : solution_(solution),
        workspace_(workspace),
        ends_(lift_offs(solution.model->span())),
        miss_(missed_by(solution)),
        jacobian_(miss_.size(), miss_.size()) {}

  int run(const Deadline& deadline) {
    if (ends_.empty()) return spent_;
    double before = INFINITY;
    for (int step = 0; step < most_steps && !deadline.passed(); ++step) {
      const double missed = miss_.cwiseAbs().maxCoeff();
      if (missed < nothing_missed) break;
      if (missed < nearly_nothing_missed && missed > before / 2) break;
      before = missed;
      if (step % most_updates == 0 && !differentiate()) break;
      Eigen::VectorXd way = bounded(-jacobian_.partialPivLu().solve(miss_));
      if (!way.allFinite() || !move(way)) break;
      if (way.cwiseAbs().maxCoeff() < settled * solution_.model->span().length) break;
    }
    return spent_;
  }

 private:
  [[nodiscard]] Eigen::VectorXd missed_by(const SpanSolution& solution) const {
    return missed(solution, ends_);
  }

  [[nodiscard]] Eigen::VectorXd bounded(Eigen::VectorXd way) const {
    const Span& span = solution_.model->span();
    double share = 1;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      const double size = std::abs(way[static_cast<Eigen::Index>(i)]);
      const Room room = room_of(span, ends_[i]);
      const bool down = way[static_cast<Eigen::Index>(i)] < 0;
      const double most =
          std::min(largest_share * (down ? room.down : room.up), longest_step * span.length);
      if (size > most) share = std::min(share, most / size);
    }
    way *= share;
    return way;
  }

  [[nodiscard]] SpanSolution with_moved(const Eigen::VectorXd& way) {
    Span span = solution_.model->span();
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      ends_[i].move(span, way[static_cast<Eigen::Index>(i)]);
    }
    SpanSolution result = with_contacts(solution_, span, workspace_);
    spent_ += std::exchange(result.evaluations, 0);
    return result;
  }

  /// @param[in,out] way  cut where it leads to no equilibrium
  /// @return whether it has been gone
  [[nodiscard]] bool move(Eigen::VectorXd& way) {
    SpanSolution trial = with_moved(way);
    for (int cut = 0; cut < most_cuts && !trial.is_equilibrium(); ++cut) {
      way /= 4;
      trial = with_moved(way);
    }
    if (!trial.is_equilibrium()) return false;
    const Eigen::VectorXd miss = missed_by(trial);
    jacobian_ += (miss - miss_ - jacobian_ * way) * way.transpose() / way.squaredNorm();
    miss_ = miss;
    solution_ = std::move(trial);
    return true;
  }

  [[nodiscard]] bool differentiate() {
    Eigen::VectorXd way = Eigen::VectorXd::Zero(miss_.size());
    for (Eigen::Index i = 0; i < miss_.size(); ++i) {
      const LiftOff& end = ends_[static_cast<std::size_t>(i)];
      const Span::Contact& contact = solution_.model->span().contacts[end.contact];
      if (!contact.lies() && contact.slides) {
        // Where a rod touches does not depend on where it is looked for.
        jacobian_.col(i) = Eigen::VectorXd::Unit(miss_.size(), i);
        continue;
      }
      const Room room = room_of(solution_.model->span(), end);
      way[i] = difference * (room.down > room.up ? -room.down : room.up);
      const SpanSolution beside = with_moved(way);
      if (!beside.is_equilibrium()) return false;
      jacobian_.col(i) = (missed_by(beside) - miss_) / way[i];
      way[i] = 0;
    }
    return true;
  }

  SpanSolution& solution_;
  SpanWorkspace& workspace_;
  std::vector<LiftOff> ends_;
  Eigen::VectorXd miss_;
  Eigen::MatrixXd jacobian_;
  int spent_ = 0;
};

}  // namespace

SpanSolution with_contacts(const SpanSolution& from, const Span& span, SpanWorkspace& workspace) {
  SpanSolution solution;
  solution.model = workspace.model(span, from.terms);
  solution.terms = from.terms;
  if (solution.model->pieces() == from.model->pieces()) {
    solution.x = solution.model->adopt(*from.model, from.x);
    solution.multipliers = from.multipliers;
    workspace.newton().polish_nearby(solution, span.total_load());
  } else {
    const TangentField near = field_of(from.model->shape(from.x));
    solution.x = solution.model->fit(near(solution.model->nodes()));
    workspace.newton().polish(solution, span.total_load());
  }
  return solution;
}

int settle_lift_offs(SpanSolution& solution, const Deadline& deadline, SpanWorkspace& workspace) {
  return Settling(solution, workspace).run(deadline);
}

}  // namespace dlo::energy_model
