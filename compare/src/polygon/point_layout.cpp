#include "polygon/point_layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/taut_line.hpp"
#include "dlo/force_model/step_size.hpp"
#include "scene/scene_problem.hpp"

namespace dlo::compare {
namespace {

/// Extent of the segment that a gripper holds, on both sides of the gripper's arc length, in
/// segments.
struct HeldExtent {
  double before = 0;
  double after = 0;
};

HeldExtent held_extent(const Scene& scene, const Gripper& gripper, Bookkeeping bookkeeping) {
  if (!gripper.direction) return {};
  if (bookkeeping == Bookkeeping::consistent) return {.before = 0.5, .after = 0.5};
  return gripper.at == scene.length ? HeldExtent{.before = 1} : HeldExtent{.after = 1};
}

/// An interval of the rod between two grips, or between a grip and a free end.
struct Gap {
  double begin = 0;  // arc lengths of the grips or ends [m]
  double end = 0;
  double reach_begin = 0;  // parts of the held segments inside the gap, in segments
  double reach_end = 0;
  Eigen::Index segments = 1;

  [[nodiscard]] double free_length(double L) const {
    return end - begin - (reach_begin + reach_end) * L;
  }
};

/// Two grippers that are closer than this share of the rod's length hold the same point.
constexpr double same_point = 1e-9;

std::string where(const Scene& scene, const Gripper& gripper) {
  return gripper.where.empty() ? scene.file : gripper.where;
}

std::vector<Gap> gaps_between(const Scene& scene, const std::vector<std::size_t>& along,
                              Bookkeeping bookkeeping) {
  std::vector<Gap> gaps;
  Gap gap;
  for (const std::size_t index : along) {
    const Gripper& gripper = scene.grippers[index];
    const HeldExtent grip_reach = held_extent(scene, gripper, bookkeeping);
    gap.end = gripper.at;
    gap.reach_end = grip_reach.before;
    if (gripper.at > 0) gaps.push_back(gap);
    gap = {.begin = gripper.at, .reach_begin = grip_reach.after};
  }
  gap.end = scene.length;
  if (gap.begin < scene.length) gaps.push_back(gap);
  return gaps;
}

/// Returns the number of segments inside end grippers, beyond the rod; a fraction with the
/// consistent bookkeeping.
double segments_beyond_ends(const Scene& scene, Bookkeeping bookkeeping) {
  double beyond = 0;
  for (const Gripper& gripper : scene.grippers) {
    const HeldExtent grip_reach = held_extent(scene, gripper, bookkeeping);
    if (gripper.at == 0) beyond += grip_reach.before;
    if (gripper.at == scene.length) beyond += grip_reach.after;
  }
  return beyond;
}

void require_enough_points(const Scene& scene, const ForceModelSettings& settings,
                           const std::vector<Gap>& gaps, double beyond, Eigen::Index clamps) {
  constexpr double least_free_part = 0.5;  // free part of a gap, in segments
  double segments = static_cast<double>(clamps) + static_cast<double>(gaps.size());
  double closest = scene.length;
  for (const Gap& gap : gaps) {
    const double asked = gap.reach_begin + gap.reach_end + least_free_part;
    segments = std::max(segments, beyond + scene.length * asked / (gap.end - gap.begin));
    closest = std::min(closest, gap.end - gap.begin);
  }
  // A ratio that exceeds an integer only by rounding needs no further point.
  const double needed = 1 + std::ceil(segments - 1e-9);
  if (settings.points >= needed) return;
  throw InputError(fmt::format(
      "{}: force_model.points = {}: needs at least {:.0f} points for {} gripper{}, with as little "
      "as {:g} m of rod beside one (allowed: {:.0f} or more)",
      scene.file, settings.points, needed, scene.grippers.size(),
      scene.grippers.size() == 1 ? "" : "s", closest, needed));
}

/// Distributes `segments` over the gaps, one at a time, each to the gap whose segments are longest.
void distribute_segments(std::vector<Gap>& gaps, Eigen::Index segments, double L) {
  const auto longer = [L](const Gap& a, const Gap& b) {
    // If lengths differ only by rounding, the first gap counts as the longest.
    return a.free_length(L) / static_cast<double>(a.segments) * (1 + 1e-9) <
           b.free_length(L) / static_cast<double>(b.segments);
  };
  for (auto left = segments - static_cast<Eigen::Index>(gaps.size()); left > 0; --left) {
    ++std::max_element(gaps.begin(), gaps.end(), longer)->segments;
  }
}

/// Whether grips hold the whole rod taut on a line without forces across it, and taut_line() solves
/// it.
bool is_taut_line_case(const Scene& scene) {
  const energy_model::Problem problem = scene_problem(scene);
  if (!energy_model::is_taut_line(problem)) return false;
  try {
    return energy_model::taut_line(problem).has_value();
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// The rod between two neighbouring grips, without the segments that they hold.
struct GripInterval {
  double distance = 0;  // distance between the two points [m]
  double rod = 0;       // sum of the segments' rest lengths [m]
  Eigen::Index segments = 0;

  /// Whether segments of these rest lengths reach from grip to grip: a single segment must have the
  /// length of the gap, within `strain`; several may bend.
  [[nodiscard]] bool is_feasible(double strain) const {
    if (distance > rod * (1 + 1e-9)) return false;
    return segments > 1 || distance >= rod * (1 - strain);
  }
};

std::vector<GripInterval> grip_intervals(const Layout& layout,
                                         const std::vector<force_model::Grip>& grips) {
  std::vector<GripInterval> result;
  for (std::size_t k = 0; k + 1 < layout.along.size(); ++k) {
    const force_model::Grip& a = grips[layout.along[k]];
    const force_model::Grip& b = grips[layout.along[k + 1]];
    const Eigen::Index last = a.first_point + a.targets.cols() - 1;
    const Eigen::Index segments = b.first_point - last;
    result.push_back({(b.targets.col(0) - a.targets.rightCols<1>()).norm(),
                      layout.rest_lengths.segment(last, segments).sum(), segments});
  }
  return result;
}

bool are_grips_feasible(const Layout& layout, const std::vector<force_model::Grip>& grips,
                        double strain) {
  const std::vector<GripInterval> all = grip_intervals(layout, grips);
  return std::all_of(all.begin(), all.end(),
                     [strain](const GripInterval& between) { return between.is_feasible(strain); });
}

/// Returns the smallest number of points, above that of the settings, with which the held segments
/// leave enough rod between grips; 0 if none of the next 3000 numbers does.
int least_feasible_points(const Scene& scene, ForceModelSettings settings, double strain) {
  constexpr int most_more = 3000;
  const int last = settings.points + most_more;
  for (++settings.points; settings.points <= last; ++settings.points) {
    const Layout layout = lay_out(scene, settings);
    if (are_grips_feasible(layout, grips_of(scene, layout), strain)) return settings.points;
  }
  return 0;
}

/// Sets dt and c of the stepper `verlet`; see step_options.
void choose_time_step(const Discretisation& discretisation, force_model::StepOptions& options) {
  const force_model::Rod& rod = discretisation.rod;
  const force_model::ModeBounds modes =
      force_model::mode_bounds(rod, discretisation.starts.front());
  // Only points that move count: one inside a gripper may have no mass.
  double lightest = std::numeric_limits<double>::infinity();
  for (const double mass : rod.masses) {
    if (mass > 0) lightest = std::min(lightest, mass);
  }
  if (!std::isfinite(lightest)) return;  // Simulation reports what is missing
  options.time_step = verlet_step_share * 2 / std::sqrt(modes.fastest / lightest);
  options.damping_rate = 2 * std::sqrt(modes.slowest / rod.masses.maxCoeff());
}

/// Returns the indices of the scene's grippers in the order of their arc lengths.
/// @throws InputError naming file, line and key if two hold one arc length, or are further apart
/// than the rod between them
std::vector<std::size_t> order_along(const Scene& scene) {
  std::vector<std::size_t> along;
  for (const Gripper* gripper : grippers_by_arc_length(scene)) {
    along.push_back(static_cast<std::size_t>(gripper - scene.grippers.data()));
  }
  for (std::size_t i = 0; i + 1 < along.size(); ++i) {
    const Gripper& a = scene.grippers[along[i]];
    const Gripper& b = scene.grippers[along[i + 1]];
    const double rod = b.at - a.at;
    const double distance = (b.position - a.position).norm();
    if (!(rod > same_point * scene.length)) {
      throw InputError(fmt::format(
          "{}: gripper.at = {} m: two grippers hold this arc length (allowed: one at each)",
          where(scene, b), b.at));
    }
    if (distance > rod * (1 + 1e-12)) {
      throw InputError(
          fmt::format("{}: gripper.position: {} m from the gripper at = {} m (allowed: rod.stretch "
                      "= true, which "
                      "model exact takes; or no more than the {} m of rod between them)",
                      where(scene, b), distance, a.at, rod));
    }
  }
  return along;
}

}  // namespace

void require_slack(const Scene& scene) {
  if (scene.stretch == Stretch::counted || is_taut_line_case(scene)) return;
  const std::vector<std::size_t> along = order_along(scene);
  for (std::size_t i = 0; i + 1 < along.size(); ++i) {
    const Gripper& a = scene.grippers[along[i]];
    const Gripper& b = scene.grippers[along[i + 1]];
    const double distance = (b.position - a.position).norm();
    if (distance < b.at - a.at) continue;
    const char* const couple =
        scene.has_couples() ? ", and load.torque: a couple that is not on a clamp of a taut rod "
                              "depends on its tension, which is undetermined"
                            : "";
    throw InputError(fmt::format(
        "{}: gripper.position: {} m from the gripper at = {} m{} (allowed: rod.stretch = true, "
        "which model exact takes; less than the {} m of rod between them; or all of a round "
        "straight rod taut on a line, clamps and forces along it and couples on clamps; models "
        "chain and force take a taut rod)",
        where(scene, b), distance, a.at, couple, b.at - a.at));
  }
}

Layout lay_out(const Scene& scene, const ForceModelSettings& settings) {
  Layout layout;
  layout.along = order_along(scene);
  std::vector<Gap> gaps = gaps_between(scene, layout.along, settings.bookkeeping);
  const double beyond = segments_beyond_ends(scene, settings.bookkeeping);
  Eigen::Index clamps = 0;
  for (const Gripper& gripper : scene.grippers) clamps += gripper.direction ? 1 : 0;
  require_enough_points(scene, settings, gaps, beyond, clamps);
  const double L = scene.length / (settings.points - 1 - beyond);
  layout.segment_length = L;
  distribute_segments(gaps, settings.points - 1 - clamps, L);

  layout.rest_lengths.resize(settings.points - 1);
  layout.first_held.resize(scene.grippers.size());
  Eigen::Index point = 0;
  const auto add_gap = [&](const Gap& gap) {
    // The segments of a single gap have the length L to the last digit.
    const double length =
        gaps.size() == 1 ? L : gap.free_length(L) / static_cast<double>(gap.segments);
    const double first = gap.begin + gap.reach_begin * L;
    for (Eigen::Index i = 0; i < gap.segments; ++i) {
      layout.arc_length.push_back(first + length * static_cast<double>(i));
      layout.rest_lengths[point++] = length;
    }
  };
  std::size_t next_gap = 0;
  for (const std::size_t index : layout.along) {
    const Gripper& gripper = scene.grippers[index];
    if (gripper.at > 0) add_gap(gaps[next_gap++]);
    layout.first_held[index] = point;
    if (!gripper.direction) continue;
    const HeldExtent grip_reach = held_extent(scene, gripper, settings.bookkeeping);
    layout.arc_length.push_back(gripper.at - grip_reach.before * L);
    layout.rest_lengths[point++] = L;
  }
  if (next_gap < gaps.size()) add_gap(gaps[next_gap]);
  const Gripper& last = scene.grippers[layout.along.back()];
  layout.arc_length.push_back(last.at < scene.length
                                  ? scene.length
                                  : scene.length +
                                        held_extent(scene, last, settings.bookkeeping).after * L);
  if (gaps.size() == 1) {
    // Equal segments are counted from one end, so that no arc length depends on the positions of
    // the grips.
    for (std::size_t i = 1; i + 1 < layout.arc_length.size(); ++i) {
      layout.arc_length[i] = layout.arc_length.front() + L * static_cast<double>(i);
    }
  }
  return layout;
}

std::vector<force_model::Grip> grips_of(const Scene& scene, const Layout& layout) {
  std::vector<force_model::Grip> grips;
  for (std::size_t i = 0; i < scene.grippers.size(); ++i) {
    const Gripper& gripper = scene.grippers[i];
    force_model::Grip& hold = grips.emplace_back();
    hold.first_point = layout.first_held[i];
    hold.reference = gripper.position;
    if (!gripper.direction) {
      hold.targets = gripper.position;
      continue;
    }
    const double at = layout.arc_length[static_cast<std::size_t>(hold.first_point)];
    hold.targets = force_model::grip_targets(gripper.position, *gripper.direction,
                                             layout.segment_length, gripper.at - at);
  }
  return grips;
}

void require_feasible_grips(const Scene& scene, const ForceModelSettings& settings,
                            const Layout& layout, const std::vector<force_model::Grip>& grips) {
  const double strain = largest_strain(scene, settings);
  if (are_grips_feasible(layout, grips, strain)) return;
  const int needed = least_feasible_points(scene, settings, strain);
  const std::string allowed =
      needed > 0 ? fmt::format("{} or more", needed) : std::string("more points");
  for (const GripInterval& between : grip_intervals(layout, grips)) {
    if (between.is_feasible(strain)) continue;
    throw InputError(
        fmt::format("{}: force_model.points = {}: held segments of {:g} m leave {:g} m of rod in "
                    "{} segment{} between points that two grippers hold {:g} m apart (allowed: {})",
                    scene.file, settings.points, layout.segment_length, between.rod,
                    between.segments, between.segments == 1 ? "" : "s", between.distance, allowed));
  }
}

PointMasses point_masses(const Scene& scene, const ForceModelSettings& settings) {
  // Forces on the points under an acceleration of 1 along -y, in which only masses have weight.
  Scene weighed = scene;
  weighed.gravity = {0, -1, 0};
  for (PointLoad& load : weighed.loads) load.force = load.mass * weighed.gravity;
  weighed.distributed_loads.clear();
  ForceModelSettings with_mass = settings;
  if (scene.gravity.isZero(0)) with_mass.point_weight.reset();
  if (with_mass.point_weight) *with_mass.point_weight /= scene.gravity.norm();
  const Discretisation polygon = discretise(weighed, with_mass);
  return {-polygon.weights.row(1), polygon.weights.row(1) - polygon.rod.loads.row(1)};
}

force_model::StepOptions step_options(const ForceModelSettings& settings,
                                      const Discretisation& discretisation) {
  force_model::StepOptions options;
  options.policy = force_model::policy(settings.stepper);
  if (settings.stepper == Stepper::verlet) choose_time_step(discretisation, options);
  if (options.policy.integration != force_model::Integration::along_force) return options;
  if (options.policy.automatic) {
    options.l_s = settings.l_s.value_or(0);
    return options;
  }
  const Parameters& parameters = discretisation.parameters;
  options.c_F =
      settings.c_F.value_or(table_1_step_share * parameters.segment_length / (2 * parameters.c_c));
  options.l_s = settings.l_s.value_or(table_1_limit_share * parameters.segment_length);
  options.c_h = settings.c_h.value_or(dynamic_share);
  return options;
}

void set_masses(const Scene& scene, const ForceModelSettings& settings,
                Discretisation& discretisation) {
  if (settings.stepper != Stepper::verlet) return;
  const PointMasses masses = point_masses(scene, settings);
  discretisation.rod.masses = masses.rod + masses.hanging;
}

}  // namespace dlo::compare
