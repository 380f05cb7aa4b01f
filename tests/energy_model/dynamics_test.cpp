// Tests of the moving rod against its energy balance, against a polygon of rigid segments with
// another integrator, against vibrations, and against the equilibria that slow motion approaches.

#include "dlo/energy_model/dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "dlo/energy_model/energy.hpp"
#include "problems.hpp"
#include "rigid_polygon.hpp"
#include "solved.hpp"

namespace dlo::energy_model {
namespace {

constexpr double first_beta = 1.8751040687119612;
/// Period of a cantilever with EI = l = rho A = 1.
constexpr double first_period = 2 * pi / (first_beta * first_beta);

MovingRod with_unit_mass(const Problem& problem) {
  return {.problem = problem, .inertia = {.mass_per_length = 1}};
}

MovingRod moving_cantilever(double gamma) {
  return with_unit_mass(test::heavy_cantilever(gamma, 0));
}

/// Returns a rod between two clamps that are nearer to each other than the rod is long.
MovingRod rod_between_clamps(double gamma) { return with_unit_mass(test::two_clamps(gamma, 0.8)); }

Vector3d tip(const MovingFrame& frame) { return test::point_at(frame, 1); }

Dynamics run(const MovingRod& rod, const StartingShape& start, const std::vector<double>& times,
             const DynamicsOptions& options = {}) {
  Dynamics result = test::converged(simulate(rod, start, times, options));
  EXPECT_EQ(result.frames.size(), times.size());
  return result;
}

/// Returns a motion of time, size sin(omega t), in rad or l.
std::function<MotionValue(double)> swinging(double size, double omega) {
  return [=](double time) {
    return MotionValue{size * std::sin(omega * time), size * omega * std::cos(omega * time),
                       -size * omega * omega * std::sin(omega * time)};
  };
}

TEST(Dynamics, KeepsTheEnergyOverAHundredPeriods) {
  DynamicsOptions options;
  options.terms = 6;
  options.step = first_period / 30;
  const Dynamics result = run(moving_cantilever(1), straight_rod(Vector3d::UnitX()),
                              equal_times(50, 2 * first_period), options);
  EXPECT_LT(result.energy_error, 1e-6);
  EXPECT_TRUE(std::isnan(result.error_estimate));
}

/// Velocities of the points of a motion, by central differences of its frames.
StartingVelocities velocities_between(const MovingFrame& before, const MovingFrame& after) {
  return [before = before.sample, after = after.sample,
          duration = after.time - before.time](std::span<const double> s) {
    return ((after(s).points - before(s).points) / duration).eval();
  };
}

// Velocities by differences over h have an error of h^2 / 6 times a third derivative, about 1e-7.
// The motion that continues from them has an error of that size; 1e-5 is allowed.
TEST(Dynamics, GoesOnFromTheShapeAndTheVelocitiesOfAMotion) {
  constexpr double middle = 0.7;
  constexpr double h = 1e-4;
  for (const bool is_closed : {false, true}) {
    MovingRod rod = is_closed ? rod_between_clamps(3) : moving_cantilever(3);
    rod.material_damping = 0.02;
    const GripMotion first = fixed_grip(rod.problem.grips.front().position);
    rod.motions = {[first](double time) {
      const Vector3d way(0.05, 0.03, 0.04);
      GripPose pose = first(time);
      pose.position += way * (1 - std::cos(3 * time));
      pose.velocity = way * 3 * std::sin(3 * time);
      pose.acceleration = way * 9 * std::cos(3 * time);
      return pose;
    }};
    const StartingShape rest = solve_energy(rod.problem).sample;
    const Dynamics whole = run(rod, rest, {middle - h, middle, middle + h, middle + 1});
    MovingRod later = rod;
    later.motions = {[motion = rod.motions.front()](double time) { return motion(middle + time); }};
    DynamicsOptions options;
    options.velocities = velocities_between(whole.frames[0], whole.frames[2]);
    const std::vector<double> s{0.2, 0.5, 0.8, 1};
    const Eigen::Matrix3Xd end = whole.frames.back().sample(s).points;
    const Dynamics second_part = run(later, whole.frames[1].sample, {1}, options);
    EXPECT_LT((second_part.frames.back().sample(s).points - end).norm(), 1e-5) << is_closed;
    // Without the initial velocities the motion is different.
    const Dynamics at_rest = run(later, whole.frames[1].sample, {1});
    EXPECT_GT((at_rest.frames.back().sample(s).points - end).norm(), 1e-3) << is_closed;
  }
}

// Extrapolated from 90, 135 and 180 segments, the polygon would agree to 1.1e-6 (Gamma 1) and
// 1.0e-5 (Gamma 10). The test extrapolates from 40 and 80 and allows 1e-5 and 4e-5.
TEST(Dynamics, ReleasedCantileverMovesAsAPolygonAndAsWithMoreTermsAndSmallerSteps) {
  const std::vector<double> times = equal_times(10, 0.1);
  for (const auto& [gamma, allowed] : {std::pair(1.0, 1e-5), std::pair(10.0, 4e-5)}) {
    const Dynamics rod =
        run(moving_cantilever(gamma), straight_rod(Vector3d::UnitX()), times, {.terms = 14});
    const Dynamics fine = run(moving_cantilever(gamma), straight_rod(Vector3d::UnitX()), times,
                              {.terms = 18, .tolerance = 7e-8});
    EXPECT_LT(rod.energy_error, 1e-9);
    EXPECT_GT(fine.steps, rod.steps);
    const Eigen::Matrix2Xd limit = test::limit_of_tips(40, gamma, {}, times);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const Eigen::Vector2d expected = limit.col(static_cast<Eigen::Index>(k));
      EXPECT_LT((tip(rod.frames[k]).head<2>() - expected).norm(), allowed) << gamma << " " << k;
      EXPECT_LT((tip(rod.frames[k]) - tip(fine.frames[k])).norm(), 1e-5) << gamma << " " << k;
    }
  }
}

// The rod starts from a mode's shape at rest and returns to it after the period, up to the square
// of the amplitude (1e-2 of the amplitude is allowed). With air drag the amplitude decreases as
// exp(-zeta omega t), where zeta = c / (2 rho A omega).
TEST(Dynamics, SmallMotionsAreVibrationsThatDecay) {
  MovingRod rod = moving_cantilever(3);
  const Equilibrium shape = solve_energy(rod.problem);
  const Vibrations modes = test::converged(vibrations(rod.problem, rod.inertia, shape));
  for (const std::size_t k : {0U, 1U, 2U}) {
    const VibrationMode& mode = modes.modes[k];
    const double size = 1e-4;
    const auto displaced = [&](std::span<const double> at) {
      Samples samples = shape.sample(at);
      const double h = 1e-5;
      std::vector<double> before(at.begin(), at.end());
      std::vector<double> after = before;
      for (double& s : before) s = std::max(0.0, s - h);
      for (double& s : after) s = std::min(1.0, s + h);
      const Eigen::Matrix3Xd slope = mode.shape(after) - mode.shape(before);
      for (Eigen::Index i = 0; i < slope.cols(); ++i) {
        const auto point = static_cast<std::size_t>(i);
        samples.tangents.col(i) += size * slope.col(i) / (after[point] - before[point]);
        samples.tangents.col(i).normalize();
      }
      return samples;
    };
    const Vector3d rest = test::point_at(shape, 1);
    const double period = 2 * pi / mode.omega();
    rod.material_damping = 0;
    rod.air_drag = 0;
    const Dynamics free = run(rod, displaced, {period / 2, period}, {.tolerance = 1e-9});
    const Vector3d moved = size * mode.shape(std::vector<double>{1.0}).col(0);
    EXPECT_LT((tip(free.frames[0]) - rest + moved).norm(), 1e-2 * size) << k;
    EXPECT_LT((tip(free.frames[1]) - rest - moved).norm(), 1e-2 * size) << k;
    rod.air_drag = 0.02 * mode.omega();
    const Dynamics dragged = run(rod, displaced, {period}, {.tolerance = 1e-9});
    const double left = (tip(dragged.frames[0]) - rest).dot(moved) / moved.squaredNorm();
    EXPECT_NEAR(std::log(left), -0.02 * pi, 2e-3) << k;
    EXPECT_LT(dragged.energy_error, 1e-5);
  }
}

// Every mode of a straight beam has zeta = tau omega / 2.
TEST(Dynamics, MaterialDampingIsKelvinsAndVoigts) {
  MovingRod rod = moving_cantilever(0.001);
  rod.material_damping = 0.01;
  const double omega = first_beta * first_beta;
  const double zeta = rod.material_damping * omega / 2;
  const double period = first_period / std::sqrt(1 - zeta * zeta);
  // The higher modes have decayed by then.
  const Dynamics result = run(rod, straight_rod(Vector3d::UnitX()), {2 * period, 4 * period});
  const double rest = test::point_at(solve_energy(rod.problem), 1).y();
  const double ratio = (tip(result.frames[1]).y() - rest) / (tip(result.frames[0]).y() - rest);
  EXPECT_NEAR(std::log(ratio) / (-2 * omega * zeta * period), 1, 1e-3);
  EXPECT_LT(result.energy_error, 1e-5);
  EXPECT_GT(result.frames[0].energy.dissipated, 0);
}

TEST(Dynamics, GripsDoTheWorkThatTheEnergyTakes) {
  // The clamp oscillates and rotates, in the plane and out of it.
  MovingRod rod = moving_cantilever(5);
  rod.air_drag = 0.5;
  rod.inertia.point_masses = {{0.6, 0.3}};
  rod.problem.loads = {{1, {0, -1, 0}}};
  for (const bool spatial : {false, true}) {
    // In space material damping would also resist a bent shaft that rotates about itself.
    rod.material_damping = spatial ? 0 : 0.01;
    rod.motions = {moving(Vector3d::Zero(), Vector3d(1, 1, spatial ? 1 : 0), swinging(0.1, 5),
                          spatial ? Vector3d(1, 2, 2) : Vector3d(0, 0, 1), swinging(0.4, 4))};
    const Dynamics result = run(rod, solve_energy(rod.problem).sample, equal_times(2, 0.4),
                                {.terms = 8, .tolerance = 1e-6});
    EXPECT_LT(result.energy_error, 1e-7) << spatial;
    EXPECT_GT(std::abs(result.frames.back().energy.work), 0.01);
    // A round rod that may rotate about its axis exerts no torque about it on the clamp.
    const MovingFrame& last = result.frames.back();
    const Vector3d direction = last.sample(std::vector<double>{0.0}).tangents.col(0);
    EXPECT_NEAR(last.grips[0].torque.dot(direction), 0, 1e-9 * last.grips[0].torque.norm());
    EXPECT_EQ(std::abs(tip(last).z()) > 1e-3, spatial);
  }
}

TEST(Dynamics, SectionsMassesAndWhatHangsOnTheClampAreInTheBalance) {
  MovingRod rod = moving_cantilever(5);
  rod.problem.sections = {
      {.begin = 0.3, .end = 0.6, .bending_stiffness = 3, .weight_per_length = {0, -9, 0}}};
  rod.inertia.of_sections = {2};
  rod.inertia.point_masses = {{0, 1}, {0.5, 0.2}};
  rod.problem.loads = {{0, {1, 2, 0}}, {0.7, {0, -1, 0}}};
  rod.motions = {moving(Vector3d::Zero(), Vector3d(1, 1, 0), swinging(0.2, 3), Vector3d::UnitZ(),
                        swinging(0.3, 2))};
  const Dynamics result =
      run(rod, solve_energy(rod.problem).sample, {0.3, 0.6}, {.terms = 8, .tolerance = 1e-6});
  EXPECT_LT(result.energy_error, 1e-8);
}

TEST(Dynamics, APinThatMovesInSpaceTurnsNothing) {
  MovingRod rod = moving_cantilever(5);
  rod.problem.grips[0].direction.reset();
  rod.motions = {
      moving(Vector3d::Zero(), Vector3d(1, 0, 1), swinging(0.2, 3), Vector3d::UnitZ(), {})};
  const Dynamics result =
      run(rod, straight_rod({0.2, -1, 0}), {0.3, 0.6}, {.terms = 8, .tolerance = 1e-6});
  EXPECT_LT(result.energy_error, 1e-8);
  EXPECT_GT(std::abs(tip(result.frames[1]).z()), 1e-3);
  EXPECT_LT(result.frames[1].grips[0].torque.norm(), 1e-10);
}

TEST(Dynamics, ClampsAtBothEndsMoveTheRodAndHoldIt) {
  for (const bool spatial : {false, true}) {
    MovingRod rod = rod_between_clamps(5);
    rod.material_damping = 0.003;
    const Vector3d about = spatial ? Vector3d(1, 2, 2) : Vector3d(0, 0, 1);
    rod.motions = {fixed_grip(Vector3d::Zero()),
                   moving({0.8, 0, 0}, Vector3d(-1, 1, spatial ? 1 : 0), swinging(0.1, 4), about,
                          swinging(0.5, 3))};
    const Dynamics result =
        run(rod, solve_energy(rod.problem).sample, equal_times(2, 0.3), {.tolerance = 1e-6});
    EXPECT_LT(result.energy_error, 1e-6) << spatial;
    for (const MovingFrame& frame : result.frames) {
      const GripPose pose = rod.motions[1](frame.time);
      const Samples end = frame.sample(std::vector<double>{1.0});
      EXPECT_LT((end.points.col(0) - pose.position).norm(), 1e-10);
      // At an end the tangent is extrapolated from the nodes.
      EXPECT_LT((end.tangents.col(0) - pose.turn * Vector3d::UnitX()).norm(), 1e-6);
    }
  }
}

TEST(Dynamics, DampedReactionsConvergeToThoseOfTheEquilibrium) {
  for (const bool pinned : {false, true}) {
    MovingRod rod = rod_between_clamps(20);
    rod.material_damping = 0.02;
    if (pinned) rod.problem.grips[1].direction.reset();
    const Equilibrium rest = test::require_usable(solve_energy(rod.problem));
    const Dynamics result = run(rod, rest.sample, {10}, {.terms = 16, .tolerance = 1e-6});
    for (std::size_t i = 0; i < 2; ++i) {
      const Reaction& has = result.frames[0].grips[i];
      EXPECT_LT((has.force - rest.grips[i].force).norm(), 1e-5) << pinned << " " << i;
      EXPECT_LT((has.torque - rest.grips[i].torque).norm(), 1e-5) << pinned << " " << i;
    }
    EXPECT_NEAR(result.frames[0].energy.bending, rest.energy.bending, 1e-7);
    EXPECT_LT(result.frames[0].energy.kinetic, 1e-10);
  }
}

GripMotion evenly(const Vector3d& velocity) {
  return [velocity](double time) {
    GripPose pose;
    pose.position = time * velocity;
    pose.velocity = velocity;
    return pose;
  };
}

TEST(Dynamics, AFrameThatMovesEvenlyChangesNothing) {
  const std::vector<double> times = equal_times(2, 0.1);
  MovingRod rod = moving_cantilever(5);
  const StartingShape start = straight_rod(Vector3d::UnitX());
  const Dynamics stands = run(rod, start, times);
  const Vector3d velocity(3, -2, 1);
  rod.motions = {evenly(velocity)};
  // The whole rod has the velocity at the begin.
  const Dynamics moves = run(rod, start, times);
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Vector3d apart = tip(moves.frames[k]) - tip(stands.frames[k]) - times[k] * velocity;
    EXPECT_LT(apart.norm(), 1e-6);
    EXPECT_LT((moves.frames[k].grips[0].force - stands.frames[k].grips[0].force).norm(), 1e-3);
  }
  EXPECT_LT(moves.energy_error, 1e-8);
}

// Comparison with a stiff rod that is moved at constant velocity; a flow along the rod causes no
// drag.
TEST(Dynamics, SquaredDragIsAcrossTheRod) {
  MovingRod rod = moving_cantilever(0.01);
  rod.material_damping = 0.3;
  rod.quadratic_drag = 0.1;
  const Vector3d velocity(1, 0, 0.3);
  rod.motions = {evenly(velocity)};
  const Dynamics result = run(rod, straight_rod(Vector3d::UnitX()), {20});
  EXPECT_LT(result.energy_error, 1e-7);
  const Vector3d force = result.frames[0].grips[0].force;
  const double drag = rod.quadratic_drag * velocity.z() * velocity.z();
  EXPECT_NEAR(force.z(), drag, 0.01 * drag);
  EXPECT_NEAR(force.x(), 0, 0.01 * drag);
  EXPECT_GT(result.frames[0].energy.dissipated, 19 * drag * velocity.z());
}

// A clamp approaches and rotates at a constant rate. If the rod starts with the rates of its
// equilibrium shapes, its distance from them is proportional to the square of the speed; if it
// starts without velocity, it vibrates about them. The first distance has to be less than 3 % of
// the second.
TEST(Dynamics, InMotionItFollowsItsShapesAtRestFromTheBegin) {
  MovingRod rod = rod_between_clamps(5);
  constexpr double speed = 0.005;
  const auto at = [](double time) { return MotionValue{speed * time, speed, 0}; };
  rod.motions = {nullptr, moving(rod.problem.grips[1].position, -Vector3d::UnitX(), at,
                                 Vector3d(0, 0.6, 0.8), at)};
  constexpr int terms = 12;
  const StartingShape start = solve_energy(rod.problem, {.terms = terms}).sample;
  const std::vector<double> times = equal_times(10, 0.05);
  std::vector<double> off;
  for (const bool in_motion : {true, false}) {
    const Dynamics result = run(rod, start, times, {.terms = terms, .in_motion = in_motion});
    EXPECT_LT(result.energy_error, 1e-7);
    off.push_back(0);
    for (const MovingFrame& frame : result.frames) {
      Problem now = rod.problem;
      const GripPose pose = rod.motions[1](frame.time);
      now.grips[1].position = pose.position;
      now.grips[1].direction = pose.turn * *now.grips[1].direction;
      const Equilibrium rest = solve_energy(now, {.terms = terms});
      off.back() = std::max(off.back(), test::largest_point_distance(frame, rest));
    }
  }
  EXPECT_LT(off[0], 0.03 * off[1]) << off[0] << " " << off[1];
  EXPECT_GT(off[1], 1e-4);
}

TEST(Dynamics, AClampThatStartsAtOnceStrikesTheRod) {
  MovingRod rod = moving_cantilever(0);
  const Vector3d velocity(0, 0.2, 0);
  rod.motions = {[velocity](double time) {
    GripPose pose;
    pose.position = std::max(0.0, time - 0.1) * velocity;
    if (time >= 0.1) pose.velocity = velocity;
    return pose;
  }};
  rod.breaks = {0.1};
  const Dynamics result =
      run(rod, straight_rod(Vector3d::UnitX()), {0.1, 0.101, 0.2}, {.terms = 8});
  // At first only the part of the rod near the clamp moves.
  EXPECT_LT(result.frames[0].energy.kinetic, 0.05 * 0.5 * velocity.squaredNorm());
  EXPECT_LT(std::abs(tip(result.frames[1]).y()), 1e-4);
  EXPECT_LT(result.energy_error, 1e-6);
  // The free end first moves backwards.
  EXPECT_LT(tip(result.frames[2]).y(), -1e-3);
}

// Radau's rule evaluates the motion at the end of a step. At a break, where the motion has two
// values, the one before the break is used, whichever of them the motion itself returns there.
TEST(Dynamics, AStepThatEndsAtABreakUsesOnlyTheMotionBefore) {
  constexpr double stop = 0.1;
  for (const bool pinned : {false, true}) {
    MovingRod rod = pinned ? rod_between_clamps(5) : moving_cantilever(5);
    rod.material_damping = 0.01;
    rod.air_drag = 1;
    rod.breaks = {stop};
    std::array<Dynamics, 2> runs;
    for (const bool after : {false, true}) {
      const Vector3d from = rod.problem.grips.back().position;
      const Vector3d velocity(-0.3, 0.5, 0);
      rod.motions.assign(rod.problem.grips.size(), nullptr);
      rod.motions.back() = [=](double time) {
        GripPose pose;
        pose.position = from + std::min(time, stop) * velocity;
        const bool stopped = after ? time >= stop : time > stop + 1e-14;
        if (!stopped) pose.velocity = velocity;
        return pose;
      };
      runs[after ? 1 : 0] =
          run(rod, solve_energy(rod.problem).sample, {stop, 0.2}, {.terms = 8, .tolerance = 1e-6});
    }
    EXPECT_EQ(runs[0].steps, runs[1].steps) << pinned;
    EXPECT_LT(runs[1].energy_error, 1e-5) << pinned;
    for (std::size_t k = 0; k < 2; ++k) {
      const Eigen::Matrix3Xd apart =
          runs[0].frames[k].sample(std::vector<double>{0.3, 0.5, 1}).points -
          runs[1].frames[k].sample(std::vector<double>{0.3, 0.5, 1}).points;
      EXPECT_LT(apart.norm(), 1e-9) << pinned << " " << k;
    }
  }
}

// The distance of a damped motion from the equilibria is proportional to its speed.
TEST(Dynamics, SlowMotionComesToRestingShapes) {
  MovingRod rod = moving_cantilever(5);
  rod.material_damping = 0.05;
  rod.air_drag = 2;
  std::array<double, 4> apart{};
  for (std::size_t k = 0; k < apart.size(); ++k) {
    const double takes = 20 * std::pow(10.0, static_cast<double>(k));
    rod.motions = {moving(Vector3d::Zero(), Vector3d::UnitX(), {}, Vector3d::UnitZ(),
                          smooth_step(0, takes, 1.0))};
    const Equilibrium begin = solve_energy(rod.problem);
    const Dynamics result = run(rod, begin.sample, {takes / 2}, {.tolerance = 1e-6});
    Problem turned = rod.problem;
    turned.grips[0].direction = rod.motions[0](takes / 2).turn * Vector3d::UnitX();
    const Vector3d rest = test::point_at(solve_energy(turned), 1);
    apart[k] = (tip(result.frames[0]) - rest).norm();
  }
  EXPECT_GT(apart[0], 1e-3);
  for (std::size_t k = 1; k < apart.size(); ++k) {
    EXPECT_NEAR(apart[k - 1] / apart[k], 10, k == 1 ? 1 : 0.2) << apart[k];
  }
}

TEST(Dynamics, ARodThatFallsOnAFloorThatYieldsKeepsItsEnergy) {
  MovingRod rod = moving_cantilever(10);
  rod.problem.obstacles = {{obstacle::Body::half_space({0, -0.2, 0}, {0, 1, 0}), 1e3}};
  const Dynamics result =
      run(rod, straight_rod(Vector3d::UnitX()), {0.3, 0.4, 0.5, 1}, {.tolerance = 1e-6});
  double pushed = 0;
  for (const MovingFrame& frame : result.frames) {
    pushed = std::max(pushed, frame.obstacles[0].y());
    EXPECT_LT(std::abs(frame.obstacles[0].x()), 1e-12);
  }
  EXPECT_GT(pushed, 1);
  // The force on a node has a kink in time when the node enters the floor.
  EXPECT_LT(result.energy_error, 1e-4);
}

// A clamp in the middle makes two spans; the first one has the arc length reversed.
TEST(Dynamics, BothSidesOfAClampMoveEqually) {
  MovingRod rod = moving_cantilever(8);
  rod.problem.grips[0].at = 0.5;
  const Dynamics result = run(rod, straight_rod(Vector3d::UnitX()), {0.1, 0.2});
  for (const MovingFrame& frame : result.frames) {
    const Samples ends = frame.sample(std::vector<double>{0, 1});
    EXPECT_NEAR(ends.points(0, 0), -ends.points(0, 1), 1e-12);
    EXPECT_NEAR(ends.points(1, 0), ends.points(1, 1), 1e-12);
    EXPECT_LT(frame.grips[0].torque.norm(), 1e-9);
  }
}

// The integrals over the sampled shape are computed by Simpson's rule; the second span hangs from
// its own clamp.
TEST(Dynamics, GravityAndLoadsAreZeroWherePointsSitAtTheFirstGrip) {
  MovingRod rod = moving_cantilever(5);
  rod.problem.grips[0].position = Vector3d(0.1, 0.3, 0);
  rod.problem.grips.push_back({0.5, {0.5, 0.1, 0}, Vector3d(1, -0.3, 0)});
  rod.problem.loads = {{0.8, {1, -2, 0}}};
  const Vector3d first = rod.problem.grips[0].position;
  const Dynamics result = run(rod, solve_energy(rod.problem).sample, {0.2});
  const MovingFrame& frame = result.frames[0];
  constexpr int panels = 1000;
  double gravity = 0;
  for (int i = 0; i <= 2 * panels; ++i) {
    const double share = i == 0 || i == 2 * panels ? 1 : (i % 2 == 1 ? 4 : 2);
    const Vector3d at = test::point_at(frame, i / (2.0 * panels));
    gravity -= share / (6 * panels) * rod.problem.weight_per_length.dot(at - first);
  }
  EXPECT_GT(std::abs(gravity), 0.5);
  EXPECT_NEAR(frame.energy.gravity, gravity, 1e-6);
  const Vector3d loaded = test::point_at(frame, 0.8);
  EXPECT_NEAR(frame.energy.load, -rod.problem.loads[0].force.dot(loaded - first), 1e-9);
}

// Line loads that vary along the whole rod or a part of it have the same effect in `simulate` and
// in `solve_energy`: a rod that starts in equilibrium stays there.
TEST(Dynamics, VaryingLineLoadsLeaveARodAtRestWhereItIs) {
  MovingRod rod = moving_cantilever(2);
  rod.problem.line_loads = {{0, 1, {0, 0, 0}, {0, -6, 0}}, {0.3, 0.8, {0, 5, 0}, {0, -1, 0}}};
  const Equilibrium rest = solve_energy(rod.problem);
  const Dynamics result = run(rod, rest.sample, {0.3, 0.8});
  for (const MovingFrame& frame : result.frames) {
    EXPECT_LT((tip(frame) - test::point_at(rest, 1)).norm(), 1e-7);
    EXPECT_LT(frame.energy.kinetic, 1e-10);
    EXPECT_NEAR(frame.energy.gravity, rest.energy.gravity + rest.energy.load, 1e-7);
  }
}

/// Returns a rod of given length, bending stiffness and mass, with damping, drag and a point mass,
/// over a floor. Its clamp oscillates and rotates.
MovingRod shaken_rod(double length, double stiffness, double mass) {
  const double force = stiffness / (length * length);
  const double time = std::sqrt(mass * length / force);
  MovingRod rod = moving_cantilever(5);
  rod.problem.length = length;
  rod.problem.bending_stiffness = stiffness;
  rod.problem.weight_per_length *= force / length;
  rod.problem.loads = {{0.9 * length, {0, -force, 0}}};
  rod.problem.obstacles = {{obstacle::Body::half_space({0, -0.3 * length, 0}, {0.1, 1, 0}),
                            200 * force / (length * length)}};
  rod.inertia.mass_per_length = mass / length;
  rod.inertia.point_masses = {{0.6 * length, 0.3 * mass}};
  rod.material_damping = 0.03 * time;
  rod.air_drag = 0.7 * mass / (length * time);
  rod.motions = {moving(Vector3d::Zero(), Vector3d(1, 1, 0), swinging(0.1 * length, 5 / time),
                        Vector3d::UnitZ(), swinging(0.4, 4 / time))};
  return rod;
}

// Lengths in l, forces in EI / l^2, masses in that of the rod.
TEST(Dynamics, IsTheSameInAllUnits) {
  const Dynamics unit = run(shaken_rod(1, 1, 1), straight_rod(Vector3d::UnitX()), {0.4, 0.9});
  EXPECT_GT(unit.frames[1].energy.dissipated, 0.1);
  EXPECT_GT(unit.frames[1].energy.obstacles, 1e-3);
  for (const auto& [length, stiffness, mass] :
       {std::array{0.3, 2e-3, 0.07}, std::array{4.0, 50.0, 9.0}}) {
    const double force = stiffness / (length * length);
    const double energy = force * length;
    const double time = std::sqrt(mass * length / force);
    const Dynamics other = run(shaken_rod(length, stiffness, mass), straight_rod(Vector3d::UnitX()),
                               {0.4 * time, 0.9 * time});
    EXPECT_NEAR(other.error_estimate, unit.error_estimate, 1e-3 * unit.error_estimate);
    EXPECT_NEAR(other.smallest_step / time, unit.smallest_step, 1e-3 * unit.smallest_step);
    EXPECT_NEAR(other.largest_energy / energy, unit.largest_energy, 1e-6);
    for (std::size_t k = 0; k < 2; ++k) {
      const MovingFrame& a = unit.frames[k];
      const MovingFrame& b = other.frames[k];
      EXPECT_LT((tip(a) - test::point_at(b, length) / length).norm(), 1e-6);
      using Part = EnergyBalance;
      for (const auto part : {&Part::kinetic, &Part::bending, &Part::gravity, &Part::load,
                              &Part::obstacles, &Part::dissipated, &Part::work}) {
        EXPECT_NEAR(b.energy.*part / energy, a.energy.*part, 1e-6);
      }
      EXPECT_LT((b.grips[0].force / force - a.grips[0].force).norm(), 1e-4);
      EXPECT_LT((b.grips[0].torque / energy - a.grips[0].torque).norm(), 1e-4);
      EXPECT_LT((b.obstacles[0] / force - a.obstacles[0]).norm(), 1e-4);
    }
  }
}

TEST(Dynamics, RefusesWhatItDoesNotKnow) {
  const StartingShape start = straight_rod(Vector3d::UnitX());
  const std::vector<double> times = {1};
  MovingRod coupled = moving_cantilever(1);
  coupled.problem.loads.push_back({1, Vector3d::Zero(), {0, 0, 1}});
  EXPECT_THROW((void)simulate(coupled, start, times), std::invalid_argument);
  MovingRod damped = moving_cantilever(1);
  damped.material_damping = -1;
  EXPECT_THROW((void)simulate(damped, start, times), std::invalid_argument);
  EXPECT_THROW((void)simulate(moving_cantilever(1), start, std::vector<double>{2, 1}),
               std::invalid_argument);
  EXPECT_THROW((void)straight_rod(Vector3d::Zero()), std::invalid_argument);
}

TEST(Dynamics, GripsThatPartFartherThanTheRodEndTheRunWithWhatCameBefore) {
  MovingRod rod = rod_between_clamps(1);
  rod.motions = {
      fixed_grip(Vector3d::Zero()),
      moving({0.8, 0, 0}, Vector3d::UnitX(), smooth_step(0, 1, 0.5), Vector3d::UnitZ(), {})};
  const Dynamics result = simulate(rod, solve_energy(rod.problem).sample, equal_times(10, 0.1),
                                   {.terms = 8, .tolerance = 1e-5});
  EXPECT_EQ(result.status, SolveStatus::failed);
  EXPECT_FALSE(result.frames.empty());
  EXPECT_LT(result.frames.back().time, 0.6);
}

TEST(GripMotion, RatesAreThoseOfPoses) {
  const GripMotion motion =
      moving({1, 2, 3}, {1, 1, 0}, smooth_step(0, 3, 2), {0, 1, 1}, swinging(0.5, 2));
  const double h = 1e-5;
  for (const double time : {0.3, 0.9, 1.7, 2.6}) {
    const GripPose before = motion(time - h);
    const GripPose here = motion(time);
    const GripPose after = motion(time + h);
    EXPECT_LT(((after.position - before.position) / (2 * h) - here.velocity).norm(), 1e-8);
    EXPECT_LT(((after.velocity - before.velocity) / (2 * h) - here.acceleration).norm(), 1e-7);
    const Eigen::AngleAxisd turned(after.turn * before.turn.conjugate());
    EXPECT_LT((turned.angle() * turned.axis() / (2 * h) - here.angular_velocity).norm(), 1e-6);
    EXPECT_LT(
        ((after.angular_velocity - before.angular_velocity) / (2 * h) - here.angular_acceleration)
            .norm(),
        1e-6);
  }
}

}  // namespace
}  // namespace dlo::energy_model
