#include "planar_shooting.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "silence_gsl.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

/// State along sigma = 1 - s, from the tip to the clamp, in the frame of the last force: angle psi
/// of the tangent against that force, curvature by sigma, position relative to the tip, bending
/// energy, and the potential of the weight relative to the clamp.
enum Component : std::size_t { psi, psi_rate, x, y, bending, gravity, components };
using State = std::array<double, components>;

/// Forces in the frame whose x axis is the last force.
struct Frame {
  double axis_angle = 0;  // of the last force against the clamp's tangent
  Eigen::Vector2d weight = Eigen::Vector2d::Zero();
  std::vector<PlanarCantilever::Load> loads;  // by growing sigma; `at` is sigma here

  [[nodiscard]] bool parallel() const {
    return weight.y() == 0 && std::all_of(loads.begin(), loads.end(),
                                          [](const auto& load) { return load.force.y() == 0; });
  }
};

struct Section {
  Eigen::Vector2d weight;
  Eigen::Vector2d loads;  // sum of those that have been passed
};

Eigen::Vector2d into_frame(const Eigen::Vector2d& force, double axis_angle) {
  const Eigen::Vector2d axis(std::cos(axis_angle), std::sin(axis_angle));
  Eigen::Vector2d turned(axis.dot(force), axis.x() * force.y() - axis.y() * force.x());
  // What is parallel up to rounding is parallel: it may not disturb an exponentially small psi.
  if (std::abs(turned.y()) < 1e-14 * turned.norm()) turned.y() = 0;
  return turned;
}

Frame make_frame(const PlanarCantilever& rod) {
  const bool tip_load = !rod.loads.empty() && rod.loads.back().at == 1;
  Eigen::Vector2d last = rod.weight;
  if (tip_load) {
    last.setZero();
    for (const auto& load : rod.loads) {
      if (load.at == 1) last += load.force;
    }
  } else if (last.norm() == 0 && !rod.loads.empty()) {
    last = rod.loads.back().force;
  }
  Frame frame;
  frame.axis_angle = std::atan2(last.y(), last.x());
  frame.weight = into_frame(rod.weight, frame.axis_angle);
  for (auto load = rod.loads.rbegin(); load != rod.loads.rend(); ++load) {
    frame.loads.push_back({1 - load->at, into_frame(load->force, frame.axis_angle)});
  }
  return frame;
}

int section_rates(double sigma, const double* state, double* rate, void* data) {
  const auto& section = *static_cast<const Section*>(data);
  const Eigen::Vector2d n = sigma * section.weight + section.loads;
  const double sine = std::sin(state[psi]);
  const double cosine = std::cos(state[psi]);
  rate[psi] = state[psi_rate];
  rate[psi_rate] = n.x() * sine - n.y() * cosine;
  rate[x] = -cosine;
  rate[y] = -sine;
  rate[bending] = state[psi_rate] * state[psi_rate] / 2;
  rate[gravity] = -sigma * (section.weight.x() * cosine + section.weight.y() * sine);
  return GSL_SUCCESS;
}

/// Integrates from the tip, psi = start there, through every sigma of `stops` (growing).
/// @return false if the integrator failed
bool shoot(const Frame& frame, double start, double tolerance, const std::vector<double>& stops,
           std::vector<State>& states) {
  const std::size_t n = components;
  Section section{frame.weight, Eigen::Vector2d::Zero()};
  gsl_odeiv2_system system{section_rates, nullptr, n, &section};
  const std::unique_ptr<gsl_odeiv2_step, decltype(&gsl_odeiv2_step_free)> step(
      gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, n), gsl_odeiv2_step_free);
  const std::unique_ptr<gsl_odeiv2_evolve, decltype(&gsl_odeiv2_evolve_free)> evolve(
      gsl_odeiv2_evolve_alloc(n), gsl_odeiv2_evolve_free);
  // psi may start exponentially small, and its relative error is what counts then.
  const double small = std::max(std::min(std::abs(start), 1.0), 1e-300);
  const double angle_scale = frame.parallel() ? small : 1.0;
  const std::array<double, components> scale = {angle_scale, angle_scale, 1, 1, 1, 1};
  const std::unique_ptr<gsl_odeiv2_control, decltype(&gsl_odeiv2_control_free)> control(
      gsl_odeiv2_control_scaled_new(tolerance, tolerance, 1, 0, scale.data(), n),
      gsl_odeiv2_control_free);

  State state{};
  state[psi] = start;
  double sigma = 0;
  double h = 1e-3;
  std::size_t next_load = 0;
  states.clear();
  for (const double stop : stops) {
    for (;;) {
      while (next_load < frame.loads.size() && frame.loads[next_load].at <= sigma) {
        section.loads += frame.loads[next_load++].force;
        gsl_odeiv2_evolve_reset(evolve.get());
        gsl_odeiv2_step_reset(step.get());
      }
      if (sigma >= stop) break;
      const double until =
          next_load < frame.loads.size() ? std::min(stop, frame.loads[next_load].at) : stop;
      while (sigma < until) {
        if (gsl_odeiv2_evolve_apply(evolve.get(), control.get(), step.get(), &system, &sigma, until,
                                    &h, state.data()) != GSL_SUCCESS) {
          return false;
        }
      }
    }
    states.push_back(state);
  }
  return std::isfinite(states.back()[psi]);
}

struct Shooter {
  Frame frame;
  double tolerance;
  int shots = 0;
  std::vector<State> states;

  /// How far the clamp's angle is missed; zero at every winding number.
  double miss(double start) {
    ++shots;
    if (!shoot(frame, start, tolerance, {1.0}, states)) return NAN;
    return std::sin((states.back()[psi] + frame.axis_angle) / 2);
  }
};

double miss_of(double start, void* data) { return static_cast<Shooter*>(data)->miss(start); }

/// Root of miss between two starts of different sign.
double refine_root(Shooter& shooter, double low, double high) {
  gsl_function function{miss_of, &shooter};
  const std::unique_ptr<gsl_root_fsolver, decltype(&gsl_root_fsolver_free)> solver(
      gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  if (gsl_root_fsolver_set(solver.get(), &function, low, high) != GSL_SUCCESS) return NAN;
  for (int i = 0; i < 200; ++i) {
    if (gsl_root_fsolver_iterate(solver.get()) != GSL_SUCCESS) break;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                               gsl_root_fsolver_x_upper(solver.get()), 0, 4e-16) == GSL_SUCCESS) {
      break;
    }
  }
  return gsl_root_fsolver_root(solver.get());
}

double total_load(const PlanarCantilever& rod) {
  double load = rod.weight.norm();
  for (const auto& l : rod.loads) load += l.force.norm();
  return load;
}

/// Starts psi at the tip, growing from -pi to pi. Where all forces are parallel the tip's angle
/// against them is exponentially small and the grid goes down to it. Where they are not, the tip's
/// angle has no known limit and is found to rounding only, so the rod must not magnify it too much.
std::vector<double> scan_grid(const PlanarCantilever& rod, bool parallel) {
  const double load = total_load(rod);
  std::vector<double> positive;
  const double smallest = std::exp(-std::sqrt(load) - 6);
  for (double start = smallest; start < 0.1; start *= 1.5) positive.push_back(start);
  const int uniform = parallel ? 120 : 600;
  for (int i = 0; i <= uniform; ++i) positive.push_back(0.1 + (pi - 0.1) * i / uniform);
  std::vector<double> grid;
  for (auto start = positive.rbegin(); start != positive.rend(); ++start) grid.push_back(-*start);
  grid.push_back(0);
  grid.insert(grid.end(), positive.begin(), positive.end());
  return grid;
}

std::vector<double> find_starts(Shooter& shooter, const std::vector<double>& grid) {
  std::vector<double> starts;
  double previous = NAN;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double miss = shooter.miss(grid[i]);
    // Only a tip that keeps its angle all along the rod is a root without a change of sign.
    const bool straight = grid[i] == 0 || std::abs(grid[i]) == pi;
    if (straight && std::abs(miss) < 1e-15) {
      starts.push_back(grid[i]);
    } else if (i > 0 && miss * previous < 0 && std::abs(previous) >= 1e-15) {
      const double root = refine_root(shooter, grid[i - 1], grid[i]);
      if (std::isfinite(root)) starts.push_back(root);
    }
    previous = miss;
  }
  // -pi and pi are the same tip.
  if (starts.size() > 1 && starts.front() == -pi && starts.back() == pi) starts.pop_back();
  return starts;
}

PlanarSamples sample(const Frame& frame, double start, double tolerance,
                     const std::vector<double>& distances) {
  std::vector<double> stops;
  stops.reserve(distances.size() + 1);
  for (const double s : distances) stops.push_back(1 - s);
  stops.push_back(1);
  std::sort(stops.begin(), stops.end());
  std::vector<State> states;
  PlanarSamples samples(static_cast<Eigen::Index>(distances.size()));
  if (!shoot(frame, start, tolerance, stops, states)) {
    samples.points.setConstant(NAN);
    return samples;
  }
  const State& clamp = states.back();
  const double cosine = std::cos(frame.axis_angle);
  const double sine = std::sin(frame.axis_angle);
  // The clamp's tangent is 0 up to whole turns that the rod makes on its way.
  const double turns = 2 * pi * std::round((clamp[psi] + frame.axis_angle) / (2 * pi));
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const auto at = std::lower_bound(stops.begin(), stops.end(), 1 - distances[i]);
    const State& state = states[static_cast<std::size_t>(at - stops.begin())];
    const double dx = state[x] - clamp[x];
    const double dy = state[y] - clamp[y];
    const auto column = static_cast<Eigen::Index>(i);
    samples.points.col(column) << cosine * dx - sine * dy, sine * dx + cosine * dy;
    samples.angle[column] = state[psi] + frame.axis_angle - turns;
    samples.curvature[column] = -state[psi_rate];
  }
  return samples;
}

Energies energies(const PlanarCantilever& rod, const Frame& frame, double start, double tolerance) {
  std::vector<State> states;
  Energies energies;
  if (!shoot(frame, start, tolerance, {1.0}, states)) return energies;
  energies.bending = states.back()[bending];
  energies.gravity = states.back()[gravity];
  std::vector<double> load_points;
  for (const auto& load : rod.loads) load_points.push_back(load.at);
  const PlanarSamples at_loads = sample(frame, start, tolerance, load_points);
  for (std::size_t j = 0; j < rod.loads.size(); ++j) {
    energies.load -= rod.loads[j].force.dot(at_loads.points.col(static_cast<Eigen::Index>(j)));
  }
  return energies;
}

}  // namespace

bool planar_shots_are_well_posed(const PlanarCantilever& rod) {
  constexpr double largest_parallel = 4e5;
  constexpr double largest = 60;
  return total_load(rod) <= (make_frame(rod).parallel() ? largest_parallel : largest);
}

std::vector<Equilibrium> shoot_from_tip(const Problem& problem, const ReducedCantilever& reduced,
                                        double tolerance) {
  silence_gsl();
  Shooter shooter{make_frame(reduced.rod), tolerance, 0, {}};
  const std::vector<double> starts =
      find_starts(shooter, scan_grid(reduced.rod, shooter.frame.parallel()));

  std::vector<Equilibrium> equilibria;
  for (const double start : starts) {
    Equilibrium result;
    result.residual = std::abs(shooter.miss(start)) * 2;
    if (!(result.residual < 1e-8)) continue;  // a jump of the winding, not a root
    result.status = SolveStatus::converged;
    result.message = to_string(result.status);
    const auto own = [frame = shooter.frame, start, tolerance](const std::vector<double>& s) {
      return sample(frame, start, tolerance, s);
    };
    result.energy = restore(problem, energies(reduced.rod, shooter.frame, start, tolerance));
    result.grips = {clamp_reaction(problem, reduced, own({0.0}).curvature[0])};
    result.sample = [problem, reduced, own](std::span<const double> arc_lengths) {
      return restore(problem, reduced, arc_lengths,
                     own(distances_from_clamp(problem, reduced.reversed, arc_lengths)));
    };
    equilibria.push_back(std::move(result));
  }
  for (Equilibrium& result : equilibria) result.evaluations = shooter.shots;
  // Mirror images have the same energy up to rounding; the one that bends towards the plane's y
  // comes first.
  const double unit = problem.bending_stiffness / problem.length;
  const auto tip_height = [&](const Equilibrium& e) {
    const std::vector<double> tip = {reduced.reversed ? 0.0 : problem.length};
    return reduced.plane.y.dot(e.sample(tip).points.col(0));
  };
  std::stable_sort(equilibria.begin(), equilibria.end(), [&](const auto& a, const auto& b) {
    const double difference = a.energy.total() - b.energy.total();
    const double rounding = 1e-11 * (unit + std::abs(a.energy.total()));
    if (std::abs(difference) > rounding) return difference < 0;
    return tip_height(a) > tip_height(b);
  });
  return equilibria;
}

}  // namespace dlo::energy_model
