#include "dlo/energy_model/balance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <sstream>
#include <utility>

#include "base/legendre.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// Smallest force and couple to which an imbalance is compared, as a share of EI/l^2 and EI/l. 1e-8
/// of this share is a thousand times the rounding error of a rod bent by forces of EI/l^2.
constexpr double negligible_share = 1e-4;

/// Integrates the forces and moments of distributed actions: weight, line loads and drag in the
/// first column, yielding obstacles in one column each; moments about the first grip.
class DistributedActions {
 public:
  DistributedActions(const Problem& problem, const Equilibrium& shape)
      : problem_(problem),
        shape_(shape),
        origin_(problem.grips.front().position),
        parts_(rod_parts(problem)) {
    for (std::size_t i = 0; i < problem.obstacles.size(); ++i) {
      if (std::isfinite(problem.obstacles[i].stiffness)) yielding_.push_back(i);
    }
  }

  /// Indices of the yielding obstacles in Problem::obstacles.
  [[nodiscard]] const std::vector<std::size_t>& yielding() const { return yielding_; }

  /// Returns the action of weight, line loads and drag together, then one action for each obstacle
  /// of yielding().
  /// @param middle  middle of the rod [m], at which the actions are applied, so that imbalance_of()
  ///                counts their lever arm
  [[nodiscard]] std::vector<Action> integrate(const Eigen::Vector3d& middle) const {
    constexpr int most_halvings = 24;
    constexpr std::size_t most_panels = 512;  // a shape of noise would not be resolved by more
    std::vector<Panel> panels;
    const std::vector<double> cuts = kink_positions(problem_, shape_.contacts);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      panels.push_back({cuts[i], cuts[i + 1] - cuts[i], {}, false});
    }
    sum(panels);
    double scale = 0;  // scale of the forces
    for (const Panel& panel : panels) scale += panel.sums.topRows(3).norm();
    Sums total = Sums::Zero(6, columns());
    for (int level = 0; !panels.empty(); ++level) {
      const bool last = level == most_halvings || (level > 0 && panels.size() > most_panels);
      std::vector<Panel> halves;
      for (const Panel& panel : panels) {
        halves.push_back({panel.begin, panel.width / 2, {}, false});
        halves.push_back({panel.begin + panel.width / 2, panel.width / 2, {}, false});
      }
      sum(halves);
      std::vector<Panel> open;
      for (std::size_t i = 0; i < panels.size(); ++i) {
        Panel& left = halves[2 * i];
        Panel& right = halves[2 * i + 1];
        const Sums both = left.sums + right.sums;
        const bool hides = left.may_hide_contact || right.may_hide_contact;
        if (!last && (hides || differ(panels[i].sums, both, scale))) {
          open.push_back(std::move(left));
          open.push_back(std::move(right));
        } else {
          total += both;
        }
      }
      panels = std::move(open);
    }
    return actions_of(total, middle);
  }

 private:
  using Sums = Eigen::Matrix<double, 6, Eigen::Dynamic>;
  struct Panel {
    double begin, width;
    Sums sums;
    /// Whether contact with a yielding body may begin, end or pass to another face between nodes:
    /// between an end of the panel and the adjacent node, or between two nodes that are outside of
    /// the body but near it.
    bool may_hide_contact = false;
  };

  [[nodiscard]] Eigen::Index columns() const { return 1 + std::ssize(yielding_); }

  /// Whether two sums differ by more than a panel may contribute to an imbalance; false if one is
  /// NaN.
  [[nodiscard]] bool differ(const Sums& one, const Sums& other, double scale) const {
    constexpr double share = 1e-11;
    const double force = (one - other).topRows(3).norm();
    const double moment = (one - other).bottomRows(3).norm();
    return force > share * scale || moment > share * scale * problem_.length;
  }

  void sum(std::vector<Panel>& panels) const {
    const LegendreTable& rule = legendre_table(2);
    const std::size_t Q = static_cast<std::size_t>(rule.nodes.size());
    const std::size_t samples_per_panel = Q + 2;  // begin, nodes, end
    std::vector<double> s;
    s.reserve(panels.size() * samples_per_panel);
    for (const Panel& panel : panels) {
      const auto add_sample = [&](double node) {
        s.push_back(std::clamp(panel.begin + node * panel.width, 0.0, problem_.length));
      };
      add_sample(0);
      for (const double node : rule.nodes) add_sample(node);
      add_sample(1);
    }
    const Samples samples = shape_.sample(s);
    for (std::size_t p = 0; p < panels.size(); ++p) {
      Panel& panel = panels[p];
      panel.sums.setZero(6, columns());
      const std::size_t first = p * samples_per_panel;
      panel.may_hide_contact =
          may_hide_contact(samples.points.middleCols(static_cast<Eigen::Index>(first),
                                                     static_cast<Eigen::Index>(samples_per_panel)),
                           panel.width);
      const RodPart& part = part_at(panel.begin + panel.width / 2);
      for (std::size_t q = 0; q < Q; ++q) {
        const std::size_t at = first + 1 + q;
        const auto i = static_cast<Eigen::Index>(at);
        const double ds = panel.width * rule.weights[static_cast<Eigen::Index>(q)];
        add(samples.points.col(i), samples.tangents.col(i), part, s[at], ds, panel.sums);
      }
    }
  }

  /// Whether contact with a yielding body may stay undetected in a panel.
  /// @param points  points of the rod at the begin, the nodes and the end of the panel
  [[nodiscard]] bool may_hide_contact(const Eigen::Matrix3Xd& points, double width) const {
    constexpr double half_gap = 0.1;                       // between two nodes, in panel widths
    constexpr double shortest_contact_share = 1.0 / 2048;  // shortest contact / rod length
    const Eigen::Index last = points.cols() - 1;
    return std::ranges::any_of(yielding_, [&](std::size_t i) {
      const obstacle::Body& body = problem_.obstacles[i].body;
      const Eigen::VectorXd clearance = body.clearances(points);
      const auto changes = [&](Eigen::Index one, Eigen::Index other) {
        if (clearance[one] >= 0 || clearance[other] >= 0) {
          return (clearance[one] < 0) != (clearance[other] < 0);
        }
        return body.feature(points.col(one)) != body.feature(points.col(other));
      };
      if (changes(0, 1) || changes(last - 1, last)) return true;
      const double least = clearance.minCoeff();
      return width >= shortest_contact_share * problem_.length && least >= 0 &&
             least < half_gap * width;
    });
  }

  [[nodiscard]] const RodPart& part_at(double s) const {
    const auto part = std::ranges::find_if(parts_, [&](const RodPart& own) { return s < own.end; });
    return part == parts_.end() ? parts_.back() : *part;
  }

  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& tangent, const RodPart& part,
           double s, double ds, Sums& sums) const {
    const Eigen::Vector3d arm = point - origin_;
    Eigen::Vector3d force = part.weight_per_length + (s - part.begin) * part.weight_slope;
    if (problem_.drag) force += problem_.drag->force(tangent);
    for (Eigen::Index column = 0;; ++column) {
      sums.col(column).head<3>() += ds * force;
      sums.col(column).tail<3>() += ds * arm.cross(force);
      if (column == std::ssize(yielding_)) return;
      const Obstacle& obstacle = problem_.obstacles[yielding_[static_cast<std::size_t>(column)]];
      force.setZero();
      if (obstacle.body.clearance(point) >= 0) continue;
      const obstacle::Gap gap = obstacle.body.gap(point);
      force = -obstacle.stiffness * gap.value * gap.gradient;
    }
  }

  [[nodiscard]] std::vector<Action> actions_of(const Sums& sums,
                                               const Eigen::Vector3d& point) const {
    std::vector<Action> actions;
    for (Eigen::Index column = 0; column < columns(); ++column) {
      const Eigen::Vector3d force = sums.col(column).head<3>();
      const Eigen::Vector3d moment = sums.col(column).tail<3>();
      actions.push_back({point, force, moment - (point - origin_).cross(force)});
    }
    return actions;
  }

  const Problem& problem_;
  const Equilibrium& shape_;
  const Eigen::Vector3d origin_;
  const std::vector<RodPart> parts_;
  std::vector<std::size_t> yielding_;
};

Action load_on(const Samples& samples, Eigen::Index column, const Load& load) {
  const Eigen::Vector3d point = samples.points.col(column);
  if (!load.follows) return {point, load.force, load.torque};
  const Eigen::Vector3d t = samples.tangents.col(column);
  // Without d1 the load has no component across the tangent.
  const Eigen::Vector3d d1 =
      samples.d1.cols() > 0 ? Eigen::Vector3d(samples.d1.col(column)) : t.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << d1, t.cross(d1), t;
  return {point, frame * load.force, frame * load.torque};
}

}  // namespace

Eigen::Vector3d Action::moment_about(const Eigen::Vector3d& origin) const {
  return couple + (point - origin).cross(force);
}

double Imbalance::share() const {
  const double of_force = force / largest_force;
  const double of_moment = moment / largest_moment;
  // NaN in either is returned: a comparison with NaN is false.
  return of_force > of_moment || std::isnan(of_force) ? of_force : of_moment;
}

std::string Imbalance::text() const {
  std::ostringstream text;
  text << std::setprecision(2) << "unbalanced force of " << force << " N (" << force / largest_force
       << " of the largest force) and moment of " << moment << " N m (" << moment / largest_moment
       << " of the largest moment)";
  return text.str();
}

Imbalance imbalance_of(const std::vector<Action>& actions, const Action& least) {
  Imbalance result;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double couple = least.couple.norm();
  double distance = 0;
  result.largest_force = least.force.norm();
  for (const Action& action : actions) {
    const Eigen::Vector3d arm = action.point - actions.front().point;
    force += action.force;
    moment += action.moment_about(actions.front().point);
    result.largest_force = std::max(result.largest_force, action.force.norm());
    couple = std::max(couple, action.couple.norm());
    distance = std::max(distance, arm.norm());
  }
  result.force = force.norm();
  result.moment = moment.norm();
  result.largest_moment = std::max(couple, result.largest_force * distance);
  return result;
}

Imbalance imbalance_of(const Problem& problem, const Equilibrium& shape) {
  std::vector<Action> actions;
  for (std::size_t i = 0; i < problem.grips.size(); ++i) {
    actions.push_back({problem.grips[i].position, shape.grips[i].force, shape.grips[i].torque});
  }
  std::vector<double> at;
  for (const Load& load : problem.loads) at.push_back(load.at);
  for (const ContactPart& part : shape.contacts) {
    at.push_back(std::clamp(part.begin, 0.0, problem.length));
  }
  at.push_back(problem.length / 2);
  const Samples samples = shape.sample(at);
  Eigen::Index column = 0;
  for (const Load& load : problem.loads) actions.push_back(load_on(samples, column++, load));
  std::vector<Eigen::Vector3d> differences = shape.obstacles;
  differences.resize(problem.obstacles.size(), Eigen::Vector3d::Zero());
  for (const ContactPart& part : shape.contacts) {
    actions.push_back({samples.points.col(column++), part.force, part.moment});
    differences[part.obstacle] -= part.force;
  }
  const DistributedActions spread(problem, shape);
  const std::vector<Action> sums = spread.integrate(samples.points.rightCols<1>());
  actions.insert(actions.end(), sums.begin(), sums.end());
  for (std::size_t i = 0; i < spread.yielding().size(); ++i) {
    differences[spread.yielding()[i]] -= sums[i + 1].force;
  }
  const double unit = negligible_share * bending_unit(problem) / problem.length;
  Imbalance result =
      imbalance_of(actions, {.force = {unit / problem.length, 0, 0}, .couple = {unit, 0, 0}});
  for (const Eigen::Vector3d& left : differences) {
    const double size = left.norm();
    // Once the imbalance is NaN, no later difference replaces it.
    if (size > result.force || std::isnan(size)) result.force = size;
  }
  return result;
}

void judge_balance(const Problem& problem, Equilibrium& equilibrium, double allowed) {
  const bool unjudged = equilibrium.status == SolveStatus::not_verified && !has_potential(problem);
  const bool claimed =
      succeeded(equilibrium.status) || equilibrium.status == SolveStatus::saddle || unjudged;
  if (!claimed || !equilibrium.sample) return;
  const Imbalance found = imbalance_of(problem, equilibrium);
  if (found.share() <= allowed) return;
  equilibrium.status = SolveStatus::not_verified;
  equilibrium.message = std::string(to_string(equilibrium.status)) + ": " + found.text();
}

}  // namespace dlo::energy_model
