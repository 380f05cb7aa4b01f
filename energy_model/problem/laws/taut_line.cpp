#include "dlo/energy_model/taut_line.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/require.hpp"
#include "base/sized_samples.hpp"
#include "dlo/energy_model/turns.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

/// Allowed difference of lengths, and allowed deviation of directions, positions and forces from
/// the line, relative to their sizes.
constexpr double length_rounding = 1e-12;
constexpr double line_rounding = 1e-9;

class TautLine {
 public:
  explicit TautLine(const Problem& problem)
      : problem_(problem), along_(grips_by_arc_length(problem)) {
    line_ = (grip(along_.size() - 1).position - grip(0).position).normalized();
    result_.grips.resize(problem.grips.size());
    for (const Grip& held : problem.grips) {
      if (!held.direction) continue;
      require(held.direction->normalized().cross(line_).norm() <= line_rounding &&
                  held.direction->dot(line_) > 0,
              "Problem", "arc length of a clamp of a taut rod", held.at,
              "the arc length of a clamp whose direction is along the line of the grips, which "
              "hold the whole rod straight");
    }
  }

  Equilibrium solve() {
    for (const RodPart& part : rod_parts(problem_)) add_weight(part);
    for (const Load& load : problem_.loads) add_load(load);
    add_twist();
    result_.status = SolveStatus::converged;
    result_.message =
        "converged: the grips hold the rod straight, which is its only shape; the tension of an "
        "inextensible rod is undetermined and is computed for a rod that is unstressed without "
        "loads";
    result_.residual = 0;
    result_.error_estimate = 0;
    result_.sample = sampler();
    separate_line_loads(problem_, result_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] const Grip& grip(std::size_t i) const { return *along_[i].grip; }
  [[nodiscard]] Eigen::Vector3d point(double s) const {
    return grip(0).position + (s - grip(0).at) * line_;
  }

  /// Distributes a force between the two adjacent grips.
  /// @param force  force on the line at s, between grips i and i + 1
  void distribute_force(const Eigen::Vector3d& force, double s, std::size_t i) {
    const double share = (s - grip(i).at) / (grip(i + 1).at - grip(i).at);
    result_.grips[along_[i].index].force -= (1 - share) * force;
    result_.grips[along_[i + 1].index].force -= share * force;
  }

  void require_along(const Eigen::Vector3d& force, double s) const {
    require(
        force.cross(line_).norm() <= line_rounding * force.norm(), "Problem",
        "arc length of a force across a taut rod", s,
        "none: an inextensible rod cannot hold it on a line (allowed: grips closer together, or "
        "forces along the line)");
  }

  /// Adds weight and line loads, which are linear: the rule of two points is exact for the
  /// reactions of the grips and for the energy.
  void add_weight(const RodPart& part) {
    for (std::size_t i = 0; i + 1 < along_.size(); ++i) {
      const double begin = std::max(part.begin, grip(i).at);
      const double end = std::min(part.end, grip(i + 1).at);
      if (!(end > begin)) continue;
      for (const double side : {-1.0, 1.0}) {
        const double s = (begin + end) / 2 + side * (end - begin) / std::sqrt(12);
        const Eigen::Vector3d force =
            (end - begin) / 2 * (part.weight_per_length + (s - part.begin) * part.weight_slope);
        require_along(force, s);
        distribute_force(force, s, i);
        result_.energy.gravity -= force.dot(point(s) - problem_.grips.front().position);
      }
    }
  }

  void add_load(const Load& load) {
    result_.energy.load -= load.force.dot(point(load.at) - problem_.grips.front().position);
    const std::optional<std::size_t> clamp = clamp_at_load(problem_, load);
    require(clamp || load.torque.isZero(0), "Problem", "arc length of a couple on a taut rod",
            load.at,
            "the arc length of a clamp: the share of each grip in a couple depends on the tension, "
            "which is undetermined in an inextensible rod");
    if (clamp) result_.grips[*clamp].torque -= load.torque;
    for (std::size_t i = 0; i < along_.size(); ++i) {
      if (std::abs(load.at - grip(i).at) > line_rounding * problem_.length) continue;
      result_.grips[along_[i].index].force -= load.force;
      return;
    }
    require_along(load.force, load.at);
    std::size_t i = 0;
    while (grip(i + 1).at < load.at) ++i;
    distribute_force(load.force, load.at, i);
  }

  void add_twist() {
    std::optional<std::size_t> last;
    for (const auto& [g, along] : along_) {
      const Grip& held = *along;
      if (!held.frame) continue;
      if (last) {
        const Grip& before = problem_.grips[*last];
        // The writhe of a straight line is zero, so that the held turns are all twist.
        const double angle = 2 * std::numbers::pi * held_turns(problem_, before, held).value_or(0);
        const double torque = angle / torsional_compliance(rod_parts(problem_), before.at, held.at);
        result_.twists.push_back({before.at, held.at, angle, torque});
        result_.energy.twisting += angle * torque / 2;
        result_.grips[g].torque += torque * line_;
        result_.grips[*last].torque -= torque * line_;
      } else {
        first_d1_ = Eigen::AngleAxisd(held.frame->roll, line_) * held_d1(problem_, held);
      }
      last = g;
    }
  }

  [[nodiscard]] std::function<Samples(std::span<const double>)> sampler() const {
    return [problem = problem_, start = point(0), line = line_, d1 = first_d1_,
            twists = result_.twists](std::span<const double> arc_lengths) {
      Samples samples = sized_samples(arc_lengths, problem.length);
      samples.curvature.setZero();
      samples.tangents.colwise() = line;
      if (!twists.empty()) samples.d1.resize(3, samples.points.cols());
      for (Eigen::Index i = 0; i < samples.points.cols(); ++i) {
        const double s = arc_lengths[static_cast<std::size_t>(i)];
        samples.points.col(i) = start + s * line;
        if (twists.empty()) continue;
        double angle = 0;
        for (const TwistedPart& part : twists) {
          if (!(s > part.begin)) continue;
          angle += part.torque *
                   torsional_compliance(rod_parts(problem), part.begin, std::min(s, part.end));
        }
        samples.d1.col(i) = Eigen::AngleAxisd(angle, line) * d1;
      }
      return samples;
    };
  }

  const Problem& problem_;
  std::vector<OrderedGrip> along_;
  Eigen::Vector3d line_;
  Eigen::Vector3d first_d1_ = Eigen::Vector3d::Zero();  // where the first clamp holds its frame
  Equilibrium result_;
};

}  // namespace

bool is_taut_line(const Problem& problem) {
  if (problem.grips.size() < 2 || !(problem.length > 0)) return false;
  const std::vector<OrderedGrip> along = grips_by_arc_length(problem);
  const Grip& first = *along.front().grip;
  const double rounding = length_rounding * problem.length;
  if (first.at > rounding || along.back().grip->at < problem.length - rounding) {
    return false;
  }
  const Eigen::Vector3d chord = along.back().grip->position - first.position;
  if (!(std::abs(chord.norm() - problem.length) <= rounding)) return false;
  return std::ranges::all_of(problem.grips, [&](const Grip& grip) {
    const Eigen::Vector3d there = first.position + (grip.at - first.at) / problem.length * chord;
    return (grip.position - there).norm() <= line_rounding * problem.length;
  });
}

std::optional<Equilibrium> taut_line(const Problem& problem) {
  check(problem);
  const bool plain =
      problem.obstacles.empty() && !has_material_directors(problem) && has_dead_loads(problem);
  if (!plain || !is_taut_line(problem)) return std::nullopt;
  return TautLine(problem).solve();
}

}  // namespace dlo::energy_model
