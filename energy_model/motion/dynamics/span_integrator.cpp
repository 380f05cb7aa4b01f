#include "dynamics/span_integrator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace dlo::energy_model {
namespace {

constexpr int stage_count = 4;
/// Newton's method ends when a correction is below this fraction of the step's tolerance, within
/// absolute limits in rod lengths: its error must not cause a drift of energy.
constexpr double newton_tolerance_share = 1e-4;
constexpr double largest_newton_tolerance = 1e-11;
constexpr double smallest_newton_tolerance = 1e-14;
constexpr int most_newton_corrections = 40;
/// Number of corrections above which the matrix is renewed for the next step.
constexpr int slow_convergence = 8;
/// Shortest step, as a fraction of the time scale of the rod's slowest vibration; shorter ones
/// count as a failure.
constexpr double least_step = 1e-9;

/// Returns the interval around a break of the drive, at which the velocity jumps. A step that ends
/// at the break uses the velocity before it; the step that begins there uses the velocity after it.
double break_interval(double time) { return 1e-12 * std::max(1.0, std::abs(time)); }
double before_break(double time) { return time - break_interval(time); }
double after_break(double time) { return time + break_interval(time); }

/// Rounding error of a sum of energies, divided by the sum of their magnitudes: the errors of some
/// hundred terms add up like a random walk. A heavy load on a soft rod has a potential of 1e6
/// bending energies, and a smaller step does not reduce this error.
constexpr double relative_energy_rounding = 32 * std::numeric_limits<double>::epsilon();

}  // namespace

SpanIntegrator::SpanIntegrator(SpanDynamics& span, std::function<SpanDrive(double)> drive,
                               const IntegratorOptions& options)
    : span_(span),
      drive_(std::move(drive)),
      options_(options),
      rule_(options.damped ? radau_rule() : gauss_rule()),
      newton_tolerance_(std::clamp(newton_tolerance_share * options_.tolerance,
                                   smallest_newton_tolerance, largest_newton_tolerance)) {}

bool SpanIntegrator::same_instant(double a, double b) {
  return std::abs(a - b) <= 2 * break_interval(std::max(std::abs(a), std::abs(b)));
}

void SpanIntegrator::update_mass_matrix(double time, const SpanInstant& at) {
  span_.move(drive_(time), at.x, at.v, Eigen::VectorXd::Zero(span_.size()));
  mass_ = span_.mass_matrix();
  jacobian_ = span_.jacobian();
}

/// Sets the rows of Newton's matrix that belong to one stage.
void SpanIntegrator::set_stage_rows(Eigen::Index i, double step, const PointMatrices& at,
                                    Eigen::MatrixXd& matrix) const {
  const Eigen::Index n = at.mass.rows();
  const Eigen::Index m = at.jacobian.rows();
  for (Eigen::Index j = 0; j < stage_count; ++j) {
    auto block = matrix.block(i * (n + m), j * (n + m), n, n);
    block = step * rule_.inner(i, j) * at.damping +
            step * step * rule_.double_integrals(i, j) * at.stiffness;
    if (i == j) block += at.mass;
  }
  matrix.block(i * (n + m), i * (n + m) + n, n, m) = -at.jacobian.transpose();
  matrix.block(i * (n + m) + n, i * (n + m), m, n) = at.jacobian;
}

SpanIntegrator::Factor& SpanIntegrator::factor(const SpanInstant& at, double step, bool renew) {
  // Steps that differ only by rounding of the times share a factor.
  auto found = std::find_if(factors_.begin(), factors_.end(), [&](const Factor& known) {
    return std::abs(known.step - step) <= 1e-9 * step;
  });
  if (found == factors_.end()) {
    if (factors_.size() == 6) factors_.erase(factors_.begin());
    factors_.push_back({step, {}});
    found = factors_.end() - 1;
  } else if (!renew) {
    return *found;
  }
  const Eigen::VectorXd multipliers = consistent_accelerations(at);
  const Eigen::Index n = span_.size();
  const Eigen::Index m = span_.constraints();
  const Eigen::MatrixXd damping = span_.damping(mass_);
  const Eigen::MatrixXd stiffness = span_.stiffness(multipliers);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(stage_count * (n + m), stage_count * (n + m));
  for (Eigen::Index i = 0; i < stage_count; ++i) {
    set_stage_rows(i, step, {mass_, damping, stiffness, jacobian_}, matrix);
  }
  found->lu.compute(matrix);
  return *found;
}

/// Factors Newton's matrix with the mass, damping and stiffness matrices at each predicted stage. A
/// roll of the frame that leaves the points in place has almost no mass, and mass matrices of other
/// states would give it some.
SpanIntegrator::Factor& SpanIntegrator::factor_at_stages(const SpanInstant& at, double step,
                                                         const std::vector<SpanDrive>& drives,
                                                         const Eigen::MatrixXd& guess) {
  const Eigen::Index n = span_.size();
  const Eigen::Index m = span_.constraints();
  const Eigen::MatrixXd v = (step * guess.topRows(n) * rule_.inner.transpose()).colwise() + at.v;
  const Eigen::MatrixXd x = (step * v * rule_.inner.transpose()).colwise() + at.x;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(stage_count * (n + m), stage_count * (n + m));
  for (Eigen::Index i = 0; i < stage_count; ++i) {
    span_.move(drives[static_cast<std::size_t>(i)], x.col(i), v.col(i), guess.col(i).head(n));
    mass_ = span_.mass_matrix();
    set_stage_rows(
        i, step,
        {mass_, span_.damping(mass_), span_.stiffness(guess.col(i).tail(m)), span_.jacobian()},
        matrix);
  }
  stage_factor_.step = step;
  stage_factor_.lu.compute(matrix);
  return stage_factor_;
}

/// Predicts the stages of a step by the polynomials of the previous one; zero if there is no
/// previous step, or if it did not end at the time of `at`.
Eigen::MatrixXd SpanIntegrator::predicted(const SpanInstant& at, double step,
                                          const Stages& known) const {
  if (!(known.step > 0) || known.end != at.time) {
    return Eigen::MatrixXd::Zero(span_.size() + span_.constraints(), stage_count);
  }
  return known.values * rule_.extrapolation(step / known.step).transpose();
}

/// Interpolates the stages of one step from those of its two halves.
Eigen::MatrixXd SpanIntegrator::merge_halves(const Stages& first, const Stages& second) const {
  Eigen::MatrixXd result(first.values.rows(), stage_count);
  for (Eigen::Index i = 0; i < stage_count; ++i) {
    const double at = 2 * rule_.nodes[i];
    result.col(i) = at < 1 ? first.values * rule_.interpolation(at).transpose()
                           : second.values * rule_.interpolation(at - 1).transpose();
  }
  return result;
}

bool SpanIntegrator::try_step(SpanInstant& at, double step, const Eigen::MatrixXd& guess,
                              double enough, Stages& found) {
  const Eigen::Index n = span_.size();
  const Eigen::Index m = span_.constraints();
  ++steps_;
  std::vector<SpanDrive> drives;
  for (Eigen::Index i = 0; i < stage_count; ++i) {
    // Radau's last stage is at the step's end, which may be a break.
    drives.push_back(
        drive_(std::min(at.time + rule_.nodes[i] * step, before_break(at.time + step))));
  }
  using Powers = std::array<EnergyBalance, stage_count>;
  const auto accept = [&](const Powers& powers, int corrections, Factor& newton) {
    at.x += step * at.v + step * step * (found.values.topRows(n) * rule_.last.transpose());
    at.v += step * (found.values.topRows(n) * rule_.weights);
    at.time += step;
    for (std::size_t i = 0; i < stage_count; ++i) {
      add(powers[i], step * rule_.weights[static_cast<Eigen::Index>(i)], at.done);
    }
    found.step = step;
    found.end = at.time;
    if (corrections > slow_convergence) newton.step = -1;
    return m == 0 || project(at).empty();
  };
  for (const bool renew : {false, true}) {
    Factor& newton =
        span_.has_twist()
            ? factor_at_stages(at, step, drives,
                               renew && found.values.allFinite() ? found.values : guess)
            : factor(at, step, renew);
    found.values = guess;
    Eigen::MatrixXd& values = found.values;
    Powers powers;
    Eigen::VectorXd residual(stage_count * (n + m));
    double before = std::numeric_limits<double>::infinity();
    for (int correction = 0; correction < most_newton_corrections; ++correction) {
      const Eigen::MatrixXd v =
          (step * values.topRows(n) * rule_.inner.transpose()).colwise() + at.v;
      const Eigen::MatrixXd x = (step * v * rule_.inner.transpose()).colwise() + at.x;
      for (Eigen::Index i = 0; i < stage_count; ++i) {
        const auto stage = static_cast<std::size_t>(i);
        span_.move(drives[stage], x.col(i), v.col(i), values.col(i).head(n));
        residual.segment(i * (n + m), n) = span_.residual(values.col(i).tail(m));
        residual.segment(i * (n + m) + n, m) = span_.constraint_residuals().col(2);
        powers[stage] = span_.power(span_.reactions(values.col(i).tail(m)));
      }
      const Eigen::VectorXd corrected = newton.lu.solve(residual);
      const Eigen::Map<const Eigen::MatrixXd> change(corrected.data(), n + m, stage_count);
      // Correction of velocities (root mean square) and of strains.
      const Eigen::MatrixXd moved = change.topRows(n);
      const double size =
          step * std::sqrt(std::max(0.0, (mass_ * moved).cwiseProduct(moved).sum())) +
          step * step * moved.norm();
      if (!std::isfinite(size)) break;
      values -= change;
      const bool stalled = size >= before && size < 1e3 * enough;
      if (size < enough || stalled) {
        return accept(powers, correction, newton);
      }
      if (size > 2 * before && correction > 3) break;
      before = size;
    }
  }
  return false;
}

std::string SpanIntegrator::project(SpanInstant& at) {
  if (span_.constraints() == 0) return {};
  if (mass_.size() == 0) update_mass_matrix(at.time, at);
  // The identity limits displacements of unknowns with almost no mass.
  Eigen::MatrixXd weight = mass_;
  if (span_.has_twist()) weight.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> mass(weight);
  const SpanDrive drive = drive_(before_break(at.time));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(span_.size());
  constexpr double constraint_tolerance = 1e-13;
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 30; ++i) {
    span_.move(drive, at.x, at.v, zero);
    const Eigen::MatrixX3d residuals = span_.constraint_residuals();
    const Eigen::MatrixXd jacobian = span_.jacobian();
    const Eigen::MatrixXd yields = mass.solve(jacobian.transpose());
    const Eigen::MatrixXd held_by = jacobian * yields;
    const Eigen::LDLT<Eigen::MatrixXd> solver(held_by);
    const double residual = residuals.col(0).norm();
    if (residual < constraint_tolerance ||
        (residual >= before && residual < 1e3 * constraint_tolerance)) {
      at.v -= yields * solver.solve(residuals.col(1));
      return {};
    }
    Eigen::VectorXd step = yields * solver.solve(residuals.col(0));
    if (!step.allFinite()) break;
    constexpr double longest_newton_step = 0.5;
    if (step.norm() > longest_newton_step) step *= longest_newton_step / step.norm();
    at.x -= step;
    before = residual;
  }
  return "the rod cannot reach its grips, or is straight between them";
}

std::string SpanIntegrator::equilibrate_roll(SpanInstant& at) {
  // Implicit Euler step from rest: unknowns with mass move by their acceleration times this.
  constexpr double squared_step = 1e-8;
  const Eigen::Index n = span_.size();
  const Eigen::Index m = span_.constraints();
  const SpanDrive drive = drive_(after_break(at.time));
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd begin = at.x;
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(m);
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 50; ++i) {
    span_.move(drive, at.x, zero, (at.x - begin) / squared_step);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
    matrix.topLeftCorner(n, n) = span_.mass_matrix() / squared_step + span_.stiffness(multipliers);
    const Eigen::MatrixXd jacobian = span_.jacobian();
    matrix.topRightCorner(n, m) = -jacobian.transpose();
    matrix.bottomLeftCorner(m, n) = jacobian;
    Eigen::VectorXd residual(n + m);
    residual << span_.residual(multipliers), span_.constraint_residuals().col(0);
    const Eigen::VectorXd change = matrix.partialPivLu().solve(residual);
    const double size = change.head(n).norm();
    if (!std::isfinite(size)) break;
    at.x -= change.head(n);
    multipliers -= change.tail(m);
    if (size < newton_tolerance_ || (size >= before && size < 1e3 * newton_tolerance_)) return {};
    before = size;
  }
  return "no equilibrium of the twist was found at the start";
}

std::string SpanIntegrator::advance(SpanInstant& at, double until,
                                    const std::function<bool()>& expired) {
  const bool fixed = options_.step > 0;
  while (at.time < until) {
    if (expired()) return "time limit";
    // The times of a frame and a break may differ by rounding; a step between them would evaluate
    // the motion before the break.
    if (same_instant(at.time, until)) {
      at.time = until;
      last_.end = until;
      break;
    }
    const double remaining = until - at.time;
    const double count = std::ceil(remaining / (fixed ? options_.step : next_) * (1 - 1e-9));
    const double step = remaining / count;
    if (!fixed && step < least_step && count > 1) {
      return "the time step became too small; increase the damping or change the number of terms";
    }
    if (!(fixed ? take_step(at, step) : take_two_halves(at, step))) {
      if (fixed) return "Newton's method did not converge in a time step";
      continue;
    }
    if (count <= 1) at.time = until;
    last_.end = at.time;
  }
  return {};
}

bool SpanIntegrator::take_step(SpanInstant& at, double step) {
  smallest_step_ = std::min(smallest_step_, step);
  Stages next;
  if (!try_step(at, step, predicted(at, step, last_), newton_tolerance_, next)) return false;
  last_ = std::move(next);
  if (span_.may_touch()) {
    (void)update_energy_range(before_break(at.time), at);
    depth_ = std::max(depth_, span_.depth());
  }
  return true;
}

/// Takes one step and two steps of half the size. The halves provide the initial guess of the full
/// step, and a result with a much smaller error. @return whether the step is accepted: both results
/// and the energy balance agree to the tolerance
bool SpanIntegrator::take_two_halves(SpanInstant& at, double step) {
  if (!std::isfinite(energy_)) energy_ = update_energy_range(after_break(at.time), at);
  SpanInstant once = at;
  SpanInstant twice = at;
  Stages first, second, whole;
  const bool solved =
      try_step(twice, step / 2, predicted(at, step / 2, last_), newton_tolerance_, first) &&
      try_step(twice, step / 2, predicted(twice, step / 2, first), newton_tolerance_, second) &&
      try_step(once, step, merge_halves(first, second), 1e-2 * options_.tolerance, whole);
  if (!solved) {
    next_ = 0.3 * step;
    return false;
  }
  const Eigen::VectorXd change = once.x - twice.x;
  const double difference = std::sqrt(std::max(0.0, change.dot(mass_ * change)));
  const double energy = update_energy_range(before_break(twice.time), twice);
  const double residual = std::abs(energy - energy_) - relative_energy_rounding * energy_magnitude_;
  const double error = std::max(difference, residual / largest_energy_);
  constexpr double order = 2 * stage_count + 1;
  const double better = std::pow(options_.tolerance / std::max(error, 1e-300), 1 / order);
  const double grown = std::clamp(0.9 * better, 0.25, 2.0);
  if (!(error <= options_.tolerance)) {
    next_ = step * std::min(0.7, grown);
    return false;
  }
  energy_ = energy;
  depth_ = std::max(depth_, span_.depth());
  error_ += difference;
  smallest_step_ = std::min(smallest_step_, step / 2);
  at = std::move(twice);
  last_ = std::move(second);
  if (grown > 1.4 || grown < 0.9) next_ = step * grown;
  return true;
}

/// Returns the energy at an instant plus the energy dissipated and lost so far minus the work done,
/// which is constant; updates the largest energies.
double SpanIntegrator::update_energy_range(double time, const SpanInstant& at) {
  span_.move(drive_(time), at.x, at.v, Eigen::VectorXd::Zero(span_.size()));
  const EnergyBalance energies = span_.energies();
  largest_energy_ = std::max({largest_energy_, energies.kinetic, energies.bending,
                              energies.twisting, energies.obstacles, options_.tolerance});
  energy_magnitude_ =
      std::max(energy_magnitude_, energies.kinetic + energies.bending + energies.twisting +
                                      std::abs(energies.gravity) + std::abs(energies.load) +
                                      energies.obstacles);
  return energies.total() + at.done.dissipated + at.done.lost - at.done.work;
}

void SpanIntegrator::apply_impulse(SpanInstant& at) {
  last_ = {};
  energy_ = std::numeric_limits<double>::quiet_NaN();
  next_ = first_step;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(span_.size());
  span_.move(drive_(before_break(at.time)), at.x, at.v, zero);
  const Eigen::MatrixX3d before = span_.velocities();
  const double kinetic = span_.energies().kinetic;
  at.v += solve_accelerations(after_break(at.time), at, &before).head(span_.size());
  span_.move(drive_(after_break(at.time)), at.x, at.v, zero);
  at.done.work += span_.energies().kinetic - kinetic;
}

void SpanIntegrator::set_velocities(const Eigen::MatrixX3d& given, SpanInstant& at) {
  at.v = Eigen::VectorXd::Zero(span_.size());
  at.v = solve_accelerations(after_break(at.time), at, &given).head(span_.size());
}

/// Returns accelerations and multipliers that satisfy the equations of motion; with the velocities
/// before an impact, the change of v and the impulses of the grips.
Eigen::VectorXd SpanIntegrator::solve_accelerations(double time, const SpanInstant& at,
                                                    const Eigen::MatrixX3d* before) {
  const Eigen::Index n = span_.size();
  const Eigen::Index m = span_.constraints();
  update_mass_matrix(time, at);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
  matrix.topLeftCorner(n, n) = mass_;
  matrix.topRightCorner(n, m) = -jacobian_.transpose();
  matrix.bottomLeftCorner(m, n) = jacobian_;
  Eigen::VectorXd residual(n + m);
  residual.head(n) =
      before != nullptr ? span_.impulse(*before) : span_.residual(Eigen::VectorXd::Zero(m));
  residual.tail(m) = span_.constraint_residuals().col(before != nullptr ? 1 : 2);
  return -matrix.partialPivLu().solve(residual);
}

Eigen::VectorXd SpanIntegrator::consistent_accelerations(const SpanInstant& at) {
  const double time = after_break(at.time);
  const Eigen::VectorXd found = solve_accelerations(time, at, nullptr);
  span_.move(drive_(time), at.x, at.v, found.head(span_.size()));
  return found.tail(span_.constraints());
}

}  // namespace dlo::energy_model
