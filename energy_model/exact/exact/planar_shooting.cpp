#include "exact/planar_shooting.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <numbers>

#include "base/silence_gsl.hpp"
#include "base/spin.hpp"
#include "base/zero_modes_note.hpp"
#include "exact/tip_shot.hpp"
#include "shooting/refine_span.hpp"
#include "shooting/second_variation.hpp"
#include "shooting/span_equilibrium.hpp"

namespace dlo::energy_model {
namespace {

using std::numbers::pi;

constexpr int most_shots = 20000;  // maximum number of shots of a scan
constexpr int deepest_cell = 6;    // maximum number of halvings of a cell of the scan
// Allowed error of the cubic in a cell, divided by the residual there.
constexpr double cell_resolved = 0.02;
constexpr double double_root = 1e-11;  // residual of a double root: rounding error of a shot

/// Tip angle of a shot, its residual at the clamp, and the derivative of the residual by the tip
/// angle.
struct ScanPoint {
  double start = 0;
  double residual = 0;
  double slope = 0;
};

struct Shooter {
  TipFrame frame;
  double tolerance;
  Deadline deadline;
  int shots = 0;
  int failures = 0;  // shots and root searches that did not converge
  bool out_of_time = false;
  std::exception_ptr thrown;  // exception thrown within GSL, which is C

  /// Returns the sine of half the error of the clamp's angle, which is zero at every winding
  /// number; NaN if the shot fails.
  double residual(double start) {
    return std::sin(half(is_in_time() ? shoot_angle(frame, start, tolerance) : NAN));
  }

  /// Returns the residual with its derivative.
  ScanPoint point(double start) {
    const TipShot shot = is_in_time() ? shoot(frame, start, tolerance) : TipShot{NAN, NAN};
    const double angle = half(shot.psi);
    return {start, std::sin(angle), std::cos(angle) / 2 * shot.psi_change};
  }

  bool is_in_time() {
    ++shots;
    out_of_time = out_of_time || deadline.passed();
    return !out_of_time;
  }
  double half(double psi) {
    if (!std::isfinite(psi)) ++failures;
    return (psi + frame.axis_angle) / 2;
  }
};

double residual_at(double start, void* data) {
  auto& shooter = *static_cast<Shooter*>(data);
  try {
    return shooter.residual(start);
  } catch (...) {
    shooter.thrown = std::current_exception();
    return NAN;
  }
}

double slope_of(double start, void* data) {
  auto& shooter = *static_cast<Shooter*>(data);
  try {
    return shooter.point(start).slope;
  } catch (...) {
    shooter.thrown = std::current_exception();
    return NAN;
  }
}

/// Finds a root of the residual or of its slope between two tip angles at which its signs differ;
/// NaN if it fails.
double refine_root(Shooter& shooter, double (*function_of)(double, void*), double low,
                   double high) {
  gsl_function function{function_of, &shooter};
  const auto solver =
      gsl_owned(gsl_root_fsolver_alloc(gsl_root_fsolver_brent), gsl_root_fsolver_free);
  bool good = gsl_root_fsolver_set(solver.get(), &function, low, high) == GSL_SUCCESS;
  for (int i = 0; i < 200 && good; ++i) {
    good = gsl_root_fsolver_iterate(solver.get()) == GSL_SUCCESS;
    if (gsl_root_test_interval(gsl_root_fsolver_x_lower(solver.get()),
                               gsl_root_fsolver_x_upper(solver.get()), 0, 4e-16) == GSL_SUCCESS) {
      break;
    }
  }
  if (shooter.thrown) std::rethrow_exception(shooter.thrown);
  return good ? gsl_root_fsolver_root(solver.get()) : NAN;
}

/// Returns the tip angles psi of the scan, growing from -pi to pi. If all forces are parallel, the
/// tip angle against them may be exponentially small, and the grid includes such angles. Otherwise
/// the tip angle has no known limit and is found only to rounding, so the rod must not amplify its
/// error too much.
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

/// Finds the roots of the residual, cell by cell.
class TipScan {
 public:
  explicit TipScan(Shooter& shooter) : shooter_(shooter) {}

  std::vector<double> run(const std::vector<double>& grid) {
    ScanPoint previous{};
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const ScanPoint next = shooter_.point(grid[i]);
      if (i > 0) look_into(previous, next, 0);
      // A root without a change of sign is only possible for a rod that is straight at this tip
      // angle.
      const bool straight = next.start == 0 || std::abs(next.start) == pi;
      if (straight && is_zero(next)) roots_.push_back(next.start);
      previous = next;
    }
    // The tip angles -pi and pi are the same.
    if (roots_.size() > 1 && roots_.front() == -pi && roots_.back() == pi) roots_.pop_back();
    return roots_;
  }

 private:
  static bool is_zero(const ScanPoint& point) { return std::abs(point.residual) < 1e-15; }

  /// Halves a cell until a cubic through its ends predicts the residual in its middle.
  void look_into(const ScanPoint& low, const ScanPoint& high, int depth) {
    if (!std::isfinite(low.residual) || !std::isfinite(high.residual)) return;
    const ScanPoint middle = shooter_.point((low.start + high.start) / 2);
    if (!std::isfinite(middle.residual)) return;
    const double cubic = (low.residual + high.residual) / 2 +
                         (high.start - low.start) / 8 * (low.slope - high.slope);
    const double size = std::max(
        {std::abs(low.residual), std::abs(middle.residual), std::abs(high.residual), 1e-12});
    const bool resolved = std::abs(middle.residual - cubic) <= cell_resolved * size;
    if (resolved || depth == deepest_cell || shooter_.shots > most_shots) {
      find_roots(low, middle);
      find_roots(middle, high);
    } else {
      look_into(low, middle, depth + 1);
      look_into(middle, high, depth + 1);
    }
  }

  void find_roots(const ScanPoint& low, const ScanPoint& high) {
    if (is_zero(low) || is_zero(high)) return;
    if (low.residual * high.residual < 0) {
      add(refine_root(shooter_, residual_at, low.start, high.start));
      return;
    }
    // If the residual approaches zero from both ends, the cell contains two roots or none.
    if (low.residual * low.slope >= 0 || high.residual * high.slope <= 0) return;
    const double extremum = refine_root(shooter_, slope_of, low.start, high.start);
    if (!std::isfinite(extremum)) {
      ++shooter_.failures;
      return;
    }
    const double residual = shooter_.residual(extremum);
    if (std::abs(residual) < double_root) {
      add(extremum);
    } else if (residual * low.residual < 0) {
      add(refine_root(shooter_, residual_at, low.start, extremum));
      add(refine_root(shooter_, residual_at, extremum, high.start));
    }
  }

  void add(double root) {
    if (std::isfinite(root)) {
      roots_.push_back(root);
    } else {
      ++shooter_.failures;
    }
  }

  Shooter& shooter_;
  std::vector<double> roots_;
};

/// Returns the stability of an equilibrium, from its samples and the force of its clamp.
SecondVariation stability_of(const Problem& problem, const RodSpan& span,
                             const Equilibrium& shape) {
  const auto states_of = [&](const std::vector<double>& s) {
    std::vector<double> arc_lengths;
    arc_lengths.reserve(s.size());
    for (const double at : s) arc_lengths.push_back(std::min(at * problem.length, problem.length));
    const Samples samples = shape.sample(arc_lengths);
    std::vector<RodState> states(s.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d t = samples.tangents.col(column);
      const Eigen::Vector3d curvature = samples.curvature.col(column) * problem.length;
      states[i].R = frame_along(t, t.unitOrthogonal());
      states[i].m = t.cross(curvature);
      states[i].n = implied_force(problem, shape, s[i]);
    }
    return states;
  };
  const Eigen::VectorXd probes = Eigen::VectorXd::LinSpaced(64, 0, 1);
  return second_variation(span, {}, released_frames(span),
                          bending_force(span, states_of({probes.begin(), probes.end()})),
                          states_of);
}

}  // namespace

bool planar_shots_are_well_posed(const PlanarCantilever& rod) {
  constexpr double largest_parallel = 4e5;
  constexpr double largest = 60;
  return total_load(rod) <= (tip_frame(rod).parallel() ? largest_parallel : largest);
}

TipShots shoot_from_tip(const Problem& problem, const ReducedCantilever& reduced, double tolerance,
                        const Deadline& deadline) {
  silence_gsl();
  Shooter shooter{tip_frame(reduced.rod), tolerance, deadline};
  const std::vector<double> starts =
      TipScan(shooter).run(scan_grid(reduced.rod, shooter.frame.parallel()));
  const RodSpan span = cut_at_clamps(problem).front();

  TipShots found;
  std::vector<Equilibrium>& equilibria = found.equilibria;
  for (const double start : starts) {
    Equilibrium result;
    result.residual = std::abs(shooter.residual(start)) * 2;
    if (!(result.residual < 1e-8)) continue;  // a jump of the winding number, not a root
    const auto own = [frame = shooter.frame, start, tolerance](const std::vector<double>& s) {
      return sample(frame, start, tolerance, s);
    };
    result.energy = restore(problem, energies(reduced.rod, shooter.frame, start, tolerance));
    result.grips = {clamp_reaction(problem, reduced, own({0.0}).curvature[0])};
    result.sample = [problem, reduced, own](std::span<const double> arc_lengths) {
      return restore(problem, reduced, arc_lengths,
                     own(distances_from_clamp(problem, reduced.reversed, arc_lengths)));
    };
    const SecondVariation stability = stability_of(problem, span, result);
    if (stability.negative < 0 || !std::isfinite(result.energy.total())) {
      ++shooter.failures;
      continue;
    }
    judge(stability, result);
    if (span.has_couples()) result.message += in_the_plane;
    equilibria.push_back(std::move(result));
  }
  found.complete = shooter.failures == 0 && shooter.shots <= most_shots;
  found.out_of_time = shooter.out_of_time;
  found.shots = shooter.shots;
  for (Equilibrium& result : equilibria) result.evaluations = shooter.shots;
  // Mirror images have equal energies up to rounding; the one that bends towards the plane's y
  // comes first.
  const double unit = problem.bending_stiffness / problem.length;
  const auto tip_height = [&](const Equilibrium& e) {
    const std::vector<double> tip = {reduced.reversed ? 0.0 : problem.length};
    return reduced.plane.y.dot(e.sample(tip).points.col(0));
  };
  std::stable_sort(equilibria.begin(), equilibria.end(), [&](const auto& a, const auto& b) {
    if (succeeded(a.status) != succeeded(b.status)) return succeeded(a.status);
    const double difference = a.energy.total() - b.energy.total();
    const double rounding = 1e-11 * (unit + std::abs(a.energy.total()));
    if (std::abs(difference) > rounding) return difference < 0;
    return tip_height(a) > tip_height(b);
  });
  return found;
}

}  // namespace dlo::energy_model
