#include "implicit_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dlo/force_model/step_size.hpp"
#include "point_masses.hpp"
#include "require.hpp"
#include "stiffness_terms.hpp"

namespace dlo::force_model {
namespace {

/// Number of linear solves in one step after which no further Newton step follows a gripper; its
/// points are then set to its targets.
constexpr int most_newton_steps = 64;
/// Largest rotation of a segment in one Newton step, as the tangent of the angle [-].
constexpr double largest_turn = 1;
/// A segment shorter than this fraction of its rest length has no reliable direction. Its rotation
/// is computed as if it had this length.
constexpr double least_direction_length = 0.25;
/// Fraction of the rest length to which shorter segments are opened, so that they have a direction.
constexpr double least_open_fraction = 1e-3;
/// Limit of compression in the transverse stiffness, in units of c_c / L. More compression occurs
/// only in initial shapes, and would make the stiffness indefinite.
constexpr double largest_compression = 0.01;
/// Required fraction of the decrease that the quadratic model predicts.
constexpr double armijo_share = 0.05;
/// Largest number of solves in the search for the points that touch walls. If the set is not found,
/// the last one is used until the next step.
constexpr int most_active_set_iterations = 30;
/// Largest number of halvings of a Newton step in its line search. If all fail, the step is
/// computed again with a larger shift of the stiffness matrix.
constexpr int most_halvings = 6;
/// Largest number of shifts of the stiffness matrix that are tried. Each is shift_growth times the
/// previous one, beginning with the stiffness of the slowest mode; 8^40 = 1e36 times that exceeds
/// any segment's stiffness.
constexpr int most_shifts = 40;
/// Factor by which the shift grows if it was too small, and decreases after each successful step.
constexpr double shift_growth = 8;
/// Rounding error of the energy of stiff segments, divided by the energy's parts.
constexpr double energy_rounding = 1e-12;

/// Returns 1 for points that grips hold rigidly or by springs, else 0.
std::vector<char> anchors_of(const Rod& rod) {
  std::vector<char> anchors(static_cast<std::size_t>(rod.points()), 0);
  for (const Grip& grip : rod.grips) {
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      anchors[static_cast<std::size_t>(grip.first_point + k)] = 1;
    }
  }
  return anchors;
}

}  // namespace

ImplicitStep::ImplicitStep(const Rod& rod, const Eigen::Matrix3Xd& points,
                           const StepOptions& options)
    : is_free_(free_points(rod)),
      in_plane_(rod.bending.natural_turns.size() > 0),
      time_step_(options.time_step),
      damping_rate_(options.damping_rate),
      points_(points),
      start_(points),
      velocities_(Eigen::Matrix3Xd::Zero(3, points.cols())),
      trial_(points),
      forces_(3, points.cols()),
      movement_(3, points.cols()),
      product_(3, points.cols()),
      stiffness_(points.cols()),
      factor_(points.cols()),
      retraction_(anchors_of(rod)),
      touches_(rod.walls.size() * static_cast<std::size_t>(rod.points()), 0) {
  const auto framed = std::count_if(rod.grips.begin(), rod.grips.end(),
                                    [](const Grip& grip) { return grip.d1.has_value(); });
  require(framed < 2, "Simulation", "number of grips with d1", static_cast<double>(framed),
          "0 or 1 with implicit steps, which neglect twist");
  open_segments(rod);
  const double slowest = mode_bounds(rod, points).slowest;
  unit_ = slowest;
  energy_unit_ =
      slowest * rod.length() * rod.length() + rod.loads.colwise().norm().sum() * rod.length();
  if (!std::isfinite(options.time_step)) return;
  require_masses(rod, is_free_);
  masses_ = rod.masses / time_step_;
  inertia_ = masses_ * (1 + damping_rate_ * time_step_) / time_step_;
}

/// Opens segments that are shorter than `least_open_fraction`, in the direction of contraction
/// forces: each along the chord from the point before it to the point after it. The points after
/// it, up to the next held point, move along.
void ImplicitStep::open_segments(const Rod& rod) {
  const Eigen::Index last = points_.cols() - 1;
  for (Eigen::Index i = 0; i < last; ++i) {
    const double least = least_open_fraction * rod.rest_lengths[i];
    if ((points_.col(i + 1) - points_.col(i)).norm() >= least) continue;
    const Eigen::Vector3d chord =
        points_.col(std::min(i + 2, last)) - points_.col(std::max<Eigen::Index>(i - 1, 0));
    const Eigen::Vector3d displacement = chord.norm() > 0
                                             ? Eigen::Vector3d(least / chord.norm() * chord)
                                             : Eigen::Vector3d(least, 0, 0);
    for (Eigen::Index k = i + 1; k <= last && is_free_[static_cast<std::size_t>(k)] != 0; ++k) {
      points_.col(k) += displacement;
    }
  }
}

/// Returns the potential energy E; with inertia E + sum of m (1 + c dt) |P - P_0|^2 / (2 dt^2) - m
/// v.(P - P_0) / dt.
double ImplicitStep::potential(const Rod& rod, const Eigen::Matrix3Xd& points) const {
  double result = energy(rod, points).total();
  for (Eigen::Index i = 0; i < inertia_.size(); ++i) {
    if (is_free_[static_cast<std::size_t>(i)] == 0) continue;
    const Eigen::Vector3d displacement = points.col(i) - start_.col(i);
    result += inertia_[i] / 2 * displacement.squaredNorm() -
              masses_[i] * velocities_.col(i).dot(displacement);
  }
  return result;
}

/// Computes forces and stiffness, except those of walls, which solve() adds.
void ImplicitStep::assemble(const Rod& rod) {
  total_forces(rod, points_, forces_);
  for (const Wall& wall : rod.walls) {
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      forces_.col(i) -= wall_force(wall, points_.col(i));
    }
  }
  stiffness_.set_zero();
  add_segments(rod, points_, largest_compression, stiffness_);
  add_joints(rod, points_, stiffness_);
  add_springs(rod, points_, stiffness_);
  for (Eigen::Index i = 0; i < inertia_.size(); ++i) {
    if (is_free_[static_cast<std::size_t>(i)] == 0) continue;
    stiffness_.add_to_diagonal(i, inertia_[i]);
    forces_.col(i) +=
        masses_[i] * velocities_.col(i) - inertia_[i] * (points_.col(i) - start_.col(i));
  }
}

/// Solves for the movement of the free points, given that of the held points in movement_.
bool ImplicitStep::solve_linear() {
  product_ = movement_;
  stiffness_.multiply(product_, movement_);  // K_fh dP_h
  movement_ = forces_ - movement_;
  for (Eigen::Index i = 0; i < points_.cols(); ++i) {
    if (is_free_[static_cast<std::size_t>(i)] == 0) movement_.col(i).setZero();
  }
  if (in_plane_) movement_.row(2).setZero();
  factor_.solve(movement_);
  if (in_plane_) movement_.row(2).setZero();
  for (Eigen::Index i = 0; i < points_.cols(); ++i) {
    if (is_free_[static_cast<std::size_t>(i)] == 0) movement_.col(i) = product_.col(i);
  }
  return movement_.allFinite();
}

/// Solves for the movement with walls. The energy of a wall is c_e s^2 / 2 for each point whose
/// depth s = d - n.dP is > 0, where d is the present depth. An active-set iteration finds these
/// points.
bool ImplicitStep::solve(const Rod& rod) {
  walls_energy_ = 0;
  for_each_wall_point(rod, [this](const Wall& wall, Eigen::Index i, char& touches) {
    const double depth = (wall.point - points_.col(i)).dot(wall.normal);
    touches = depth > 0 ? 1 : 0;
    if (depth > 0) add_wall_contribution(wall, i, depth, 1);
  });
  walls_energy_ = 0;  // the present contact energy is already part of energy_
  for (int iteration = 0; iteration < most_active_set_iterations; ++iteration) {
    ++newton_steps_;
    set_held_movements(rod);
    if (!factor_.compute(stiffness_, is_free_, shift_) || !solve_linear()) return false;
    bool changed = false;
    for_each_wall_point(rod, [&](const Wall& wall, Eigen::Index i, char& touches) {
      const double depth = (wall.point - points_.col(i)).dot(wall.normal);
      const char will = depth - wall.normal.dot(movement_.col(i)) > 0 ? 1 : 0;
      if (will == touches) return;
      touches = will;
      changed = true;
      add_wall_contribution(wall, i, depth, will != 0 ? 1 : -1);
    });
    if (!changed) break;
  }
  return true;
}

/// Adds the contribution of a wall on a point to the quadratic model, or removes it (sign = -1).
void ImplicitStep::add_wall_contribution(const Wall& wall, Eigen::Index i, double depth,
                                         double sign) {
  const double stiffness = sign * wall.stiffness;
  stiffness_.add(i, i, stiffness * wall.normal * wall.normal.transpose());
  forces_.col(i) += stiffness * depth * wall.normal;
  walls_energy_ += stiffness * depth * depth / 2;
}

double ImplicitStep::search(const Rod& rod, bool gripper_moves) {
  // Quadratic model: E + walls_energy - share slope + share^2 curvature / 2.
  stiffness_.multiply(movement_, product_);
  const double slope = forces_.cwiseProduct(movement_).sum();
  const double curvature = movement_.cwiseProduct(product_).sum();
  double turn = 0;
  for (Eigen::Index i = 0; i + 1 < points_.cols(); ++i) {
    const Eigen::Vector3d a = points_.col(i + 1) - points_.col(i);
    const Eigen::Vector3d d = movement_.col(i + 1) - movement_.col(i);
    const double square = a.squaredNorm();
    const Eigen::Vector3d across = square > 0 ? Eigen::Vector3d(d - a.dot(d) / square * a) : d;
    const double L = least_direction_length * rod.rest_lengths[i];
    turn = std::max(turn, across.squaredNorm() / std::max(square, L * L));
  }
  double share = std::min(1.0, largest_turn / std::sqrt(std::max(turn, 1e-300)));
  if (!energy_known_) energy_ = potential(rod, points_);
  for (int halving = 0; halving <= most_halvings; ++halving, share /= 2) {
    retraction_.move(points_, movement_, share, trial_);
    const double moved = potential(rod, trial_);
    const double predicted_energy =
        energy_ + share * (walls_energy_ - slope + share / 2 * curvature);
    const double rounding = energy_rounding * (std::abs(energy_) + energy_unit_);
    // If no gripper moves, the model's decrease is share * `decrease`. With walls the model is
    // exact only at 0 and 1; between them it is convex, so that its chord is an upper bound.
    const double decrease = slope - walls_energy_ - share / 2 * curvature;
    const double slack = gripper_moves ? std::abs(curvature) / 2 * share + 1e-3 * energy_unit_
                                       : share * (1 - armijo_share) * decrease;
    if (moved <= predicted_energy + std::max(slack, 0.0) + rounding) {
      energy_ = moved;
      return share;
    }
  }
  return 0;
}

void ImplicitStep::set_held_movements(const Rod& rod) {
  movement_.setZero();
  for_each_grip_point(rod, GripHold::rigid, [this](const Grip& grip, Eigen::Index k) {
    const Eigen::Index i = grip.first_point + k;
    movement_.col(i) = grip.targets.col(k) - points_.col(i);
  });
}

double ImplicitStep::newton_step(const Rod& rod, bool gripper_moves) {
  was_full_newton_step_ = true;
  for (int attempt = 0; attempt < most_shifts; ++attempt) {
    assemble(rod);
    if (!forces_.allFinite()) break;
    if (solve(rod)) {
      const double share = search(rod, gripper_moves);
      if (share > 0) {
        was_full_newton_step_ = was_full_newton_step_ && shift_ == 0 && share == 1;
        shift_ = shift_ > unit_ ? shift_ / shift_growth : 0;
        return share;
      }
    }
    shift_ = std::max(shift_growth * shift_, unit_);
  }
  shift_ = 0;
  was_full_newton_step_ = false;
  return 0;
}

StepResult ImplicitStep::step(const Rod& rod) {
  StepResult result;
  start_ = points_;
  newton_steps_ = 0;
  energy_known_ = false;
  set_held_movements(rod);
  const bool gripper_moves = !movement_.isZero(0);
  double share = 0;
  while (share < 1 && newton_steps_ < most_newton_steps) {
    share = newton_step(rod, gripper_moves);
    if (share == 0) break;
    points_.swap(trial_);
    energy_known_ = true;
    if (!gripper_moves) break;
  }
  for_each_grip_point(rod, GripHold::rigid, [this](const Grip& grip, Eigen::Index k) {
    points_.col(grip.first_point + k) = grip.targets.col(k);
  });
  movement_ = points_ - start_;
  if (!movement_.allFinite() || !forces_.allFinite()) {
    points_ = start_;
    return result;
  }
  result.movement = std::sqrt(movement_.colwise().squaredNorm().maxCoeff());
  movement_rms_ = movement_.norm() / std::sqrt(static_cast<double>(points_.cols()));
  if (is_dynamic()) velocities_ = movement_ / time_step_;
  result.c_m = share;
  result.limited = share < 1;
  result.status = StepStatus::good;
  return result;
}

double ImplicitStep::momentum() const {
  if (!is_dynamic()) return 0;
  double squares = 0;
  for (Eigen::Index i = 0; i < points_.cols(); ++i) {
    if (is_free_[static_cast<std::size_t>(i)] != 0) squares += velocities_.col(i).squaredNorm();
  }
  const double speed = std::sqrt(squares / static_cast<double>(points_.cols()));
  return speed > 0 ? speed / damping_rate_ : 0;
}

}  // namespace dlo::force_model
