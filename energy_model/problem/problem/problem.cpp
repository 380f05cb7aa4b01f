#include "dlo/energy_model/problem.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/require.hpp"
#include "dlo/energy_model/natural_frame.hpp"
#include "problem/rod_law.hpp"

namespace dlo::energy_model {
namespace {

void require_on_rod(const char* argument, double at, double length) {
  // Checked before require(), because composing the message costs more than all other checks of a
  // solve.
  if (at >= 0 && at <= length) return;
  require(false, "Problem", argument, at, "in [0, " + std::to_string(length) + "]");
}

void check_frame(const Grip& grip) {
  constexpr double least_across = 1e-6;
  require(grip.direction.has_value(), "Problem",
          "arc length of a grip with a frame but no direction", grip.at,
          "the arc length of a clamp, which has a direction");
  require_finite("Problem", "roll of a clamp", grip.frame->roll);
  if (!grip.frame->d1) return;
  const double across = grip.frame->d1->cross(*grip.direction).norm();
  require(across > least_across * grip.frame->d1->norm() * grip.direction->norm(), "Problem",
          "d1 of a clamp's frame, across its direction", across, "> 0");
}

void check_sections(const Problem& problem) {
  double before = 0;
  for (const Section& section : problem.sections) {
    require_on_rod("begin of a section", section.begin, problem.length);
    require_on_rod("end of a section", section.end, problem.length);
    require(section.end > section.begin, "Problem", "end of a section", section.end,
            "> its begin, " + std::to_string(section.begin));
    require(section.begin >= before, "Problem", "begin of a section", section.begin,
            ">= " + std::to_string(before) + ", the end of the previous section");
    before = section.end;
    require_positive("Problem", "bending_stiffness of a section", section.bending_stiffness);
    require_positive("Problem", "bending_stiffness_2 of a section",
                     section.bending_stiffness_2.value_or(section.bending_stiffness));
    require(section.torsional_stiffness >= 0 && std::isfinite(section.torsional_stiffness) &&
                (section.torsional_stiffness > 0 || !(problem.torsional_stiffness > 0)),
            "Problem", "torsional_stiffness of a section", section.torsional_stiffness,
            "finite, and > 0 if the rod's torsional_stiffness is");
    require_finite("Problem", "weight_per_length of a section", section.weight_per_length);
    const Eigen::Vector2d bend = section.natural_curvature.value_or(Eigen::Vector2d::Zero());
    const double twist = section.natural_twist.value_or(0);
    require(bend.allFinite() && std::isfinite(twist), "Problem", "natural strain of a section",
            bend.norm() + std::abs(twist), "finite");
    require(
        !(section.natural_curvature || section.natural_twist) || !problem.natural_strains.empty(),
        "Problem", "number of natural_strains of a rod whose sections have natural strains", 0,
        ">= 1");
  }
}

void check_material_directors(const Problem& problem) {
  require_positive("Problem", "bending_stiffness_2",
                   problem.bending_stiffness_2.value_or(problem.bending_stiffness));
  for (const Eigen::Vector3d& strain : problem.natural_strains) {
    require_finite("Problem", "natural strain", strain);
  }
  if (!has_material_directors(problem)) return;
  require_positive("Problem",
                   problem.natural_strains.empty()
                       ? "torsional_stiffness of a rod with two bending stiffnesses"
                       : "torsional_stiffness of a rod that is not intrinsically straight",
                   problem.torsional_stiffness);
}

/// Whether a rod bends only about d2, in a plane with this normal; true without material directors.
bool bends_in_plane(const Problem& problem, const Eigen::Vector3d& normal) {
  if (!has_material_directors(problem)) return true;
  const auto about_d2 = [](const Eigen::Vector3d& u) { return u.x() == 0 && u.z() == 0; };
  const bool flat = std::ranges::all_of(problem.natural_strains, about_d2) &&
                    std::ranges::all_of(problem.sections, [](const Section& section) {
                      return section.natural_curvature.value_or(Eigen::Vector2d::Zero()).x() == 0 &&
                             section.natural_twist.value_or(0) == 0;
                    });
  return flat && (!first_clamp(problem) ||
                  first_frame(problem).col(1).cross(normal).norm() < planar_tolerance);
}

}  // namespace

bool has_material_directors(const Problem& problem) {
  return !problem.natural_strains.empty() || has_two_stiffnesses(problem);
}

bool has_couples(const Problem& problem) {
  return std::ranges::any_of(problem.loads,
                             [](const Load& load) { return !load.torque.isZero(0); });
}

bool has_potential(const Problem& problem) {
  if (!has_dead_loads(problem)) return false;
  if (!has_couples(problem)) return true;
  const std::optional<Eigen::Vector3d> normal = natural_normal(problem);
  return clamps_with_frames(problem) < 2 && normal && bends_in_plane(problem, *normal);
}

void require_dead_loads(const Problem& problem, const char* function) {
  require(!problem.drag, function, "drag", problem.drag ? 1 : 0,
          "omitted: drag has no potential (only solve_exact() supports it)");
  for (const Load& load : problem.loads) {
    require(!load.follows, function, "arc length of a follower load", load.at,
            "no follower load: it has no potential (only solve_exact() supports it)");
  }
}

void check(const Problem& problem) {
  require_positive("Problem", "length", problem.length);
  require_positive("Problem", "bending_stiffness", problem.bending_stiffness);
  require_positive("Problem", "axial_stiffness", problem.axial_stiffness.value_or(1));
  require_finite("Problem", "weight_per_length", problem.weight_per_length);
  require(!problem.grips.empty(), "Problem", "number of grips", 0, ">= 1");
  for (const Grip& grip : problem.grips) {
    require_on_rod("arc length of a grip", grip.at, problem.length);
    require_finite("Problem", "position of a grip", grip.position);
    if (grip.direction) {
      require_positive("Problem", "|direction| of a clamp", grip.direction->norm());
    }
    if (grip.frame) check_frame(grip);
  }
  require(problem.torsional_stiffness > 0 || clamps_with_frames(problem) < 2, "Problem",
          "torsional_stiffness", problem.torsional_stiffness,
          "> 0 if two clamps hold the rod's frame");
  check_sections(problem);
  check_material_directors(problem);
  for (const Obstacle& obstacle : problem.obstacles) {
    const obstacle::Body& body = obstacle.body;
    require_finite("Problem", "point of an obstacle", body.centre());
    require(body.axes().allFinite(), "Problem", "axes of an obstacle", body.axes().norm(),
            "finite, with lengths > 0");
    require(body.smallest_radius() > 0, "Problem", "radius of an obstacle's edges",
            body.smallest_radius(), "> 0");
    require(obstacle.stiffness > 0, "Problem", "stiffness of an obstacle", obstacle.stiffness,
            "> 0");
  }
  for (const Load& load : problem.loads) {
    require_on_rod("arc length of a load", load.at, problem.length);
    require_finite("Problem", "force of a load", load.force);
    require_finite("Problem", "torque of a load", load.torque);
  }
  if (problem.drag) {
    require_finite("Problem", "velocity of drag", problem.drag->velocity);
    for (const double coefficient : {problem.drag->normal, problem.drag->tangential}) {
      require(coefficient >= 0 && std::isfinite(coefficient), "Problem", "coefficient of drag",
              coefficient, "finite and >= 0");
    }
  }
  for (const LineLoad& load : problem.line_loads) {
    require_on_rod("begin of a line load", load.begin, problem.length);
    require_on_rod("end of a line load", load.end, problem.length);
    require(load.end > load.begin, "Problem", "end of a line load", load.end, "> its begin");
    require(load.at_begin.allFinite() && load.at_end.allFinite(), "Problem",
            "force per length of a line load", (load.at_begin + load.at_end).norm(), "finite");
  }
}

Eigen::Vector3d LineLoad::force_between(double from, double to) const {
  const double a = std::clamp(from, begin, end);
  const double b = std::clamp(to, begin, end);
  return (b - a) * (at_begin + ((a + b) / 2 - begin) * slope());
}

std::vector<double> equal_arc_lengths(double length, Eigen::Index count) {
  require_positive("equal_arc_lengths", "length", length);
  require(count >= 2, "equal_arc_lengths", "count", static_cast<double>(count), ">= 2");
  std::vector<double> arc_lengths(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    arc_lengths[static_cast<std::size_t>(i)] =
        length * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  return arc_lengths;
}

}  // namespace dlo::energy_model
