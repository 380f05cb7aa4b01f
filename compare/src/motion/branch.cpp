#include "motion/branch.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/energy_model/couple_zero.hpp"
#include "dlo/energy_model/turns.hpp"
#include "dlo/obstacle/body.hpp"
#include "polygon/energy_problems.hpp"

namespace dlo::compare {
namespace {

/// Surface swept by a segment of the polyline, or by a part of it: bilinear between its corners.
struct SweptPatch {
  Eigen::Vector3d begin_before, end_before, begin_after, end_after;

  [[nodiscard]] Eigen::Vector3d centre() const {
    return (begin_before + end_before + begin_after + end_after) / 4;
  }
  [[nodiscard]] double length() const {
    return std::max((end_before - begin_before).norm(), (end_after - begin_after).norm());
  }
  [[nodiscard]] double displacement() const {
    return std::max((begin_after - begin_before).norm(), (end_after - end_before).norm());
  }
};

/// Whether a point of a patch is deeper in a body than `depth`. Clearances of two points differ by
/// no more than the distance of the points, so patches far from the body are skipped.
bool penetrates(const obstacle::Body& body, const SweptPatch& patch, double depth, int halvings) {
  const double clearance = body.clearance(patch.centre());
  if (clearance < -depth) return true;
  const double length = patch.length();
  const double displacement = patch.displacement();
  if (halvings == 0 || clearance - (length + displacement) / 2 > -depth) return false;
  SweptPatch first = patch;
  SweptPatch second = patch;
  if (length > displacement) {
    first.end_before = second.begin_before = (patch.begin_before + patch.end_before) / 2;
    first.end_after = second.begin_after = (patch.begin_after + patch.end_after) / 2;
  } else {
    first.begin_after = second.begin_before = (patch.begin_before + patch.begin_after) / 2;
    first.end_after = second.end_before = (patch.end_before + patch.end_after) / 2;
  }
  return penetrates(body, first, depth, halvings - 1) ||
         penetrates(body, second, depth, halvings - 1);
}

/// Returns the radius of the largest ball in a body [m]; infinite for a half-space.
double inner_radius(const obstacle::Body& body) {
  if (body.is_half_space()) return std::numeric_limits<double>::infinity();
  return body.radius() + body.upper().minCoeff();
}

/// Whether a polyline whose points move on straight lines passes through a body deeper than
/// `depth`.
/// @param before, after  its points at the begin and the end of the motion, 3 x M, M >= 2 [m]
/// @param depth          > 0 [m]
bool sweeps_through_body(const obstacle::Body& body, const Eigen::Matrix3Xd& before,
                         const Eigen::Matrix3Xd& after, double depth) {
  constexpr int most_halvings = 24;
  for (Eigen::Index i = 0; i + 1 < before.cols(); ++i) {
    const SweptPatch patch{before.col(i), before.col(i + 1), after.col(i), after.col(i + 1)};
    if (penetrates(body, patch, depth, most_halvings)) return true;
  }
  return false;
}

using energy_model::Equilibrium;

/// Largest number of steps in one frame, kept or not, and of snaps in it that are resolved one by
/// one.
constexpr int most_branch_steps = 96;
constexpr int most_snaps = 4;

/// Number of steps of the rejected size beyond the last shape within which an extrapolated quantity
/// must vanish for a branch to have ended. It is larger than 1 because the smallest eigenvalue has
/// a vertical tangent at a fold, so that a straight line through two values reaches zero late.
constexpr double extrapolation_steps = 4;

/// Energy differences that rounding and the solver's tolerance may cause, divided by EI/l plus the
/// largest work of gravity and loads [-].
constexpr double energy_noise = 1e-8;

/// Checks that no gripper is in an obstacle. @throws InputError if one is
void require_grippers_clear(const Scene& now) {
  for (std::size_t g = 0; g < now.grippers.size(); ++g) {
    for (std::size_t i = 0; i < now.obstacles.size(); ++i) {
      const double depth = -now.obstacles[i].body.clearance(now.grippers[g].position);
      if (!(depth > 1e-9 * now.length)) continue;
      throw InputError(
          fmt::format("gripper {} is {:.4g} m too near to obstacle {}, which the rod would enter",
                      g + 1, depth, i + 1));
    }
  }
}

/// Returns the rotation vector of the shortest rotation from one direction to another [rad]; zero
/// if they are parallel or opposite.
Eigen::Vector3d turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d across = from.cross(to);
  const double sine = across.norm();
  if (!(sine > 0)) return Eigen::Vector3d::Zero();
  return std::atan2(sine, from.dot(to)) / sine * across;
}

/// Returns the decrease of the couples' potential between two shapes that is caused by the motion
/// of its zero with a clamp or a chord [J]. Whole turns that couple_zero() does not count are
/// counted here, since the tangent there rotates by less than half a turn in a step.
double potential_shift_of_couples(const SolvedInstant& before, const SolvedInstant& after) {
  if (!after.scene.has_couples()) return 0;
  const energy_model::Problem from = energy_problem(before.scene);
  const energy_model::Problem to = energy_problem(after.scene);
  double energy = 0;
  for (std::size_t i = 0; i < to.loads.size(); ++i) {
    const energy_model::Load& load = to.loads[i];
    if (load.torque.isZero(0)) continue;
    const energy_model::CoupleZero was = couple_zero(from, from.loads[i]);
    const energy_model::CoupleZero is = couple_zero(to, load);
    const Eigen::Vector3d tangent_was = before.rod.sample({{was.at}}).tangents.col(0);
    const Eigen::Vector3d tangent_is = after.rod.sample({{is.at}}).tangents.col(0);
    energy += load.torque.dot(turn_between(is.direction, tangent_is) -
                              turn_between(was.direction, tangent_was) -
                              turn_between(tangent_was, tangent_is));
  }
  return energy;
}

/// Work done on the rod between two frames: by the mean of the forces, with a bound for other
/// forces. The bound allows for forces between those of both frames, or beyond them by as much as
/// the forces changed in the step before (near an extreme value a force may be the same in both
/// frames).
class Work {
 public:
  /// @param step     time between the two shapes [frames]
  /// @param changes  rates of change of the forces in the step before [per frame], one for each
  ///                 add(); empty if there is none. Set to those of this step.
  Work(double step, std::vector<Eigen::Vector3d>& changes) : step_(step), changes_(changes) {}

  void add(const Eigen::Vector3d& before, const Eigen::Vector3d& after,
           const Eigen::Vector3d& moved) {
    if (next_ == changes_.size()) changes_.emplace_back(Eigen::Vector3d::Zero());
    Eigen::Vector3d& last = changes_[next_++];
    done += (before + after).dot(moved) / 2;
    bound += (std::abs((after - before).dot(moved)) + step_ * last.norm() * moved.norm()) / 2;
    last = (after - before) / step_;
  }

  double done = 0;   ///< work by the trapezoidal rule [J]
  double bound = 0;  ///< bound of the error of `done` [J]

 private:
  double step_ = 1;
  std::vector<Eigen::Vector3d>& changes_;
  std::size_t next_ = 0;
};

/// Returns the rotation of each clamp that holds the frame about its direction, in addition to the
/// shortest rotation between its two directions [rad]. On a round straight rod the frame of the
/// first clamp is arbitrary; it follows the shortest rotation.
std::vector<double> rolls_between(const Scene& before, const Scene& after) {
  std::vector<double> rolls(after.grippers.size(), 0.0);
  for (std::size_t i = 0; i < rolls.size(); ++i) {
    const Gripper& to = after.grippers[i];
    if (to.frame) rolls[i] = to.frame->roll - before.grippers[i].frame->roll;
  }
  if (!after.prescribes_twist() || after.has_material_directors()) return rolls;
  const energy_model::Problem from = energy_problem(before);
  energy_model::Problem to = energy_problem(after);
  const auto carried = [&](std::size_t i) -> Eigen::Vector3d {
    return Eigen::Quaterniond::FromTwoVectors(*from.grips[i].direction, *to.grips[i].direction) *
           held_d1(from, from.grips[i]);
  };
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < to.grips.size(); ++i) {
    if (to.grips[i].frame && !(first && to.grips[*first].at < to.grips[i].at)) first = i;
  }
  if (!to.grips[*first].frame->d1) to.grips[*first].frame->d1 = carried(*first);
  for (std::size_t i = 0; i < to.grips.size(); ++i) {
    if (!to.grips[i].frame) continue;
    const Eigen::Vector3d was = carried(i);
    const Eigen::Vector3d is = held_d1(to, to.grips[i]);
    rolls[i] += std::atan2(to.grips[i].direction->normalized().dot(was.cross(is)), was.dot(is));
  }
  return rolls;
}

Work work_between(const SolvedInstant& before, const SolvedInstant& after, double step,
                  const std::vector<std::size_t>& obstacles,
                  std::vector<Eigen::Vector3d>& changes) {
  Work work(step, changes);
  const std::vector<double> rolls = rolls_between(before.scene, after.scene);
  for (std::size_t i = 0; i < after.scene.grippers.size(); ++i) {
    const Gripper& from = before.scene.grippers[i];
    const Gripper& to = after.scene.grippers[i];
    work.add(before.rod.grips[i].force, after.rod.grips[i].force, to.position - from.position);
    if (!to.direction) continue;
    Eigen::Vector3d turn = turn_between(*from.direction, *to.direction);
    // A rotation about the direction half-way makes the sum of both exact to second order.
    if (to.frame) turn += rolls[i] * (*from.direction + *to.direction).normalized();
    work.add(before.rod.grips[i].torque, after.rod.grips[i].torque, turn);
  }
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    const Eigen::Vector3d moved = after.scene.obstacles[obstacles[k]].body.centre() -
                                  before.scene.obstacles[obstacles[k]].body.centre();
    work.add(before.rod.obstacles[k], after.rod.obstacles[k], moved);
  }
  return work;
}

/// Whether the rod passed through an obstacle in a step: its points would be deep inside the
/// obstacle on straight paths between both shapes. False for half-spaces, and for obstacles that
/// are too thin for the number of points.
bool passes_through(const SolvedInstant& before, const SolvedInstant& after,
                    const std::vector<std::size_t>& obstacles) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](std::size_t i) {
    const obstacle::Body& body = before.scene.obstacles[i].body;
    const double radius = inner_radius(body);
    if (!std::isfinite(radius)) return false;
    // Depth, divided by the radius, that the chords of a rod that lies or slides on the obstacle do
    // not reach.
    constexpr double share = 0.25;
    constexpr double most_points = 513;
    const double length = before.scene.length;
    const double points = std::clamp(std::ceil(2 * length / radius) + 1, 33.0, most_points);
    const double depth = std::max(share * radius, length / points / 2);
    if (depth > radius / 2) return false;
    const std::vector<double> s = equal_arc_lengths(length, static_cast<int>(points));
    const Eigen::Vector3d moved = after.scene.obstacles[i].body.centre() - body.centre();
    const Eigen::Matrix3Xd from = before.rod.sample(s).points;
    const Eigen::Matrix3Xd to = after.rod.sample(s).points.colwise() - moved;
    return sweeps_through_body(body, from, to, depth);
  });
}

/// Returns the extrapolated position at which a quantity with the values a and b is zero, measured
/// from b in units of the distance from a to b; infinite if it does not decrease towards zero.
double extrapolated_zero(double a, double b) {
  if (!(b >= 0 && a > b)) return std::numeric_limits<double>::infinity();
  return b / (a - b);
}

}  // namespace

SceneEnergies energies_of(const SolvedInstant& moment) {
  const Scene& now = moment.scene;
  const Equilibrium& rod = moment.rod;
  const Eigen::Vector3d zero = now.grippers.front().position;
  SceneEnergies energy = rod.energy;
  energy.gravity -= now.weight_between(0, now.length).dot(zero);
  for (const PointLoad& load : now.loads) energy.load -= load.force.dot(zero);
  energy.load -= now.distributed_between(0, now.length).dot(zero);
  energy.load += moment.couple_potential_offset;
  return energy;
}

bool branch_ends_before(const BranchSample& before, const BranchSample& last, double rejected) {
  const double interval = last.at - before.at;
  if (!(interval > 0)) return false;
  const double most = extrapolation_steps * rejected / interval;
  const double a = before.smallest_eigenvalue;
  const double b = last.smallest_eigenvalue;
  if (std::min(extrapolated_zero(a, b), extrapolated_zero(a * a, b * b)) <= most) return true;
  if (before.contacts.size() != last.contacts.size()) return false;
  for (std::size_t i = 0; i < last.contacts.size(); ++i) {
    const double was = before.contacts[i].force.norm();
    if (extrapolated_zero(was, last.contacts[i].force.norm()) <= most) return true;
  }
  return false;
}

Branch::Branch(const Scene& scene, const FrameClock& clock,
               const energy_model::EnergyOptions& options)
    : scene_(scene),
      clock_(clock),
      obstacles_(obstacles_ever_in_reach(scene, clock)),
      solver_(options) {
  bool yields = false;
  for (const std::size_t i : obstacles_) {
    yields = yields || std::isfinite(scene.obstacles[i].stiffness);
  }
  // The rotation of a material's directors by a clamp about their tangent, and the energy stored in
  // a yielding obstacle, are not known.
  has_energy_balance_ =
      !yields && !(scene.has_material_directors() &&
                   (scene.prescribes_twist() || !clock_.scene(scene, 0).planar()));
  const double loads = scene.weight_between(0, scene.length).norm() + scene.total_load_magnitude();
  noise_ = energy_noise * (scene.bending_stiffness() / scene.length + loads * scene.length);
}

void Branch::begin() {
  Scene scene = clock_.scene(scene_, 0);
  require_grippers_clear(scene);
  Equilibrium rod = solver_.solve(frame_problem(scene, obstacles_));
  now_ = {std::move(scene), std::move(rod)};
  record_sample(0);
}

Passage Branch::next() {
  ++frame_;
  Passage passage;
  if (!is_stationary()) {
    advance_to_frame(passage);
  } else {
    passage.is_stationary = true;
  }
  if (!has_energy_balance_) passage.released = std::numeric_limits<double>::quiet_NaN();
  return passage;
}

void Branch::advance_to_frame(Passage& passage) {
  if (last_samples_) {
    for (BranchSample& record_sample : *last_samples_) record_sample.at -= 1;
  }
  double at = 0;
  double step = 1;
  int accepted_steps = 0;
  int snaps = 0;
  for (int made = 0; at < 1; ++made) {
    step = std::min(step, 1 - at);
    if (made < most_branch_steps && step >= smallest_step) {
      if (try_follow(scene_at(at + step), at, step, passage)) {
        at += step;
        if (++accepted_steps == 2) step *= 2;
      } else {
        accepted_steps = 0;
        passage.has_smaller_steps = true;
        step /= 2;
      }
      continue;
    }
    // The shape just beyond the end of the branch is the best start for the shape after the snap.
    const bool near = made < most_branch_steps && ++snaps <= most_snaps;
    const double rejected = near ? std::min(2 * step, 1 - at) : 1 - at;
    at += leave_branch(at, rejected, passage);
    const double bound = passage.released_bound;
    if (!energy_model::succeeded(now_.rod.status) || passage.released < -bound) return;
    step = 1 - at;
    accepted_steps = 0;
  }
}

/// Leaves the branch: finds an equilibrium beyond the branch's end, starting from its last shape.
/// The equilibrium is searched `rejected` frames after the last shape or, if none is found there,
/// at the frame. If none is found there either, the lowest shape at the frame is searched.
/// @return number of frames from the last shape to the equilibrium
double Branch::leave_branch(double at, double rejected, Passage& passage) {
  if (passage.stayed_on_branch) {
    passage.stayed_on_branch = false;
    passage.last_eigenvalue = now_.rod.smallest_eigenvalue;
    passage.end_was_observed = true;
    passage.released = 0;
    passage.released_bound = 0;
  }
  passage.end_was_observed = passage.end_was_observed &&
                             branch_ends_before((*last_samples_)[0], (*last_samples_)[1], rejected);
  double step = rejected;
  SolvedInstant after{scene_at(at + step), {}};
  after.rod = solver_.follow(frame_problem(after.scene, obstacles_));
  if (!energy_model::succeeded(after.rod.status) && at + step < 1) {
    solver_.undo();
    step = 1 - at;
    after.scene = scene_at(1);
    after.rod = solver_.follow(frame_problem(after.scene, obstacles_));
  }
  // Close to a bifurcation, following the last shape may result in an unstable one.
  if (!energy_model::succeeded(after.rod.status)) {
    after.rod = solver_.solve(frame_problem(after.scene, obstacles_));
  }
  if (energy_model::succeeded(after.rod.status)) {
    after.couple_potential_offset =
        now_.couple_potential_offset + potential_shift_of_couples(now_, after);
    const Work work = work_between(now_, after, step, obstacles_, changes_);
    const double grown = energies_of(after).total() - energies_of(now_).total();
    passage.work += work.done;
    passage.released += work.done - grown;
    passage.released_bound += work.bound + noise_;
  }
  now_ = std::move(after);
  // Samples of the former branch contain no information about the end of the new one.
  last_samples_.reset();
  record_sample(at + step);
  // Changes of forces across a jump do not contain it either.
  changes_.clear();
  return step;
}

/// Whether nothing has moved since the last frame, so that the rod rests too.
bool Branch::is_stationary() const {
  const Scene scene = clock_.scene(scene_, frame_);
  return scene.grippers == now_.scene.grippers && scene.obstacles == now_.scene.obstacles;
}

Scene Branch::scene_at(double share) const {
  Scene scene =
      share < 1 ? clock_.scene_before(scene_, frame_, share) : clock_.scene(scene_, frame_);
  require_grippers_clear(scene);
  return scene;
}

/// Makes one step on the branch; returns false and leaves the state unchanged if it cannot be kept.
bool Branch::try_follow(Scene scene, double from, double step, Passage& passage) {
  std::optional<Equilibrium> rod = solver_.try_follow(frame_problem(scene, obstacles_));
  if (!rod) return false;
  SolvedInstant after{std::move(scene), std::move(*rod)};
  after.couple_potential_offset =
      now_.couple_potential_offset + potential_shift_of_couples(now_, after);
  std::vector<Eigen::Vector3d> changes = changes_;
  const Work work = work_between(now_, after, step, obstacles_, changes);
  const double released = work.done - (energies_of(after).total() - energies_of(now_).total());
  const bool other_branch = has_energy_balance_ && std::abs(released) > work.bound + noise_;
  if (other_branch || passes_through(now_, after, obstacles_)) {
    solver_.undo();
    return false;
  }
  changes_ = std::move(changes);
  passage.work += work.done;
  if (passage.stayed_on_branch) {
    passage.released += released;
    passage.released_bound += work.bound + noise_;
  }
  now_ = std::move(after);
  record_sample(from + step);
  return true;
}

void Branch::record_sample(double at) {
  BranchSample seen{at, now_.rod.smallest_eigenvalue, now_.rod.contacts};
  if (!last_samples_) {
    last_samples_ = {seen, seen};
  } else {
    (*last_samples_)[0] = std::exchange((*last_samples_)[1], std::move(seen));
  }
}

}  // namespace dlo::compare
