#include "exact/tip_shot.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/silence_gsl.hpp"

namespace dlo::energy_model {
namespace {

/// State along sigma = 1 - s, from the tip to the clamp, in the frame of the last force: angle psi
/// of the tangent from that force, its derivative by sigma, position relative to the tip, bending
/// energy, and potential of the weight relative to the clamp. On request also the derivatives of
/// psi and its rate by psi at the tip.
enum TipComponent : std::size_t {
  psi,
  psi_rate,
  x,
  y,
  bending,
  gravity,
  components,
  psi_change = components,
  psi_rate_change,
  components_and_changes
};
using TipState = std::array<double, components_and_changes>;

constexpr int most_shot_steps = 100000;  // maximum number of integrator steps in a shot

struct TipSection {
  Eigen::Vector2d weight;
  Eigen::Vector2d loads;  // sum of the loads between the tip and sigma
  bool changes = false;   // whether derivatives by psi at the tip are integrated
};

Eigen::Vector2d into_frame(const Eigen::Vector2d& force, double axis_angle) {
  const Eigen::Vector2d axis(std::cos(axis_angle), std::sin(axis_angle));
  Eigen::Vector2d turned(axis.dot(force), axis.x() * force.y() - axis.y() * force.x());
  // A force that is parallel up to rounding is made parallel, because it must not disturb an
  // exponentially small psi.
  if (std::abs(turned.y()) < 1e-14 * turned.norm()) turned.y() = 0;
  return turned;
}

int section_rates(double sigma, const double* state, double* rate, void* data) {
  const auto& section = *static_cast<const TipSection*>(data);
  const Eigen::Vector2d n = sigma * section.weight + section.loads;
  const double sine = std::sin(state[psi]);
  const double cosine = std::cos(state[psi]);
  rate[psi] = state[psi_rate];
  rate[psi_rate] = n.x() * sine - n.y() * cosine;
  rate[x] = -cosine;
  rate[y] = -sine;
  rate[bending] = state[psi_rate] * state[psi_rate] / 2;
  rate[gravity] = -sigma * (section.weight.x() * cosine + section.weight.y() * sine);
  if (section.changes) {
    rate[psi_change] = state[psi_rate_change];
    rate[psi_rate_change] = (n.x() * cosine + n.y() * sine) * state[psi_change];
  }
  return GSL_SUCCESS;
}

/// Integrates through every sigma of `stops`, which grow.
/// @param changes  whether the derivatives by `start` are integrated too
/// @return false if the integrator failed; `states` is then incomplete
bool integrate(const TipFrame& frame, double start, double tolerance,
               const std::vector<double>& stops, std::vector<TipState>& states, bool changes) {
  const std::size_t n = changes ? components_and_changes : components;
  TipSection section{frame.weight, Eigen::Vector2d::Zero(), changes};
  gsl_odeiv2_system system{section_rates, nullptr, n, &section};
  silence_gsl();
  const auto step =
      gsl_owned(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, n), gsl_odeiv2_step_free);
  const auto evolve = gsl_owned(gsl_odeiv2_evolve_alloc(n), gsl_odeiv2_evolve_free);
  // At the tip psi may be exponentially small; its relative error is then controlled.
  const double small = std::max(std::min(std::abs(start), 1.0), 1e-300);
  const double angle_scale = frame.parallel() ? small : 1.0;
  const std::array<double, components_and_changes> scale = {angle_scale, angle_scale, 1, 1,
                                                            1,           1,           1, 1};
  const auto control =
      gsl_owned(gsl_odeiv2_control_scaled_new(tolerance, tolerance, 1, 0, scale.data(), n),
                gsl_odeiv2_control_free);

  TipState state{};
  state[psi] = start;
  state[psi_change] = 1;
  int steps = 0;
  double sigma = 0;
  double h = 1e-3;
  std::size_t next_load = 0;
  states.clear();
  for (const double stop : stops) {
    for (;;) {
      while (next_load < frame.loads.size() && frame.loads[next_load].at <= sigma) {
        // Derivative by sigma, which is minus the curvature.
        state[psi_rate] -= frame.loads[next_load].couple;
        section.loads += frame.loads[next_load++].force;
        gsl_odeiv2_evolve_reset(evolve.get());
        gsl_odeiv2_step_reset(step.get());
      }
      if (sigma >= stop) break;
      const double until =
          next_load < frame.loads.size() ? std::min(stop, frame.loads[next_load].at) : stop;
      while (sigma < until) {
        if (gsl_odeiv2_evolve_apply(evolve.get(), control.get(), step.get(), &system, &sigma, until,
                                    &h, state.data()) != GSL_SUCCESS ||
            ++steps > most_shot_steps) {
          return false;
        }
      }
    }
    states.push_back(state);
  }
  return std::isfinite(states.back()[psi]);
}

}  // namespace

bool TipFrame::parallel() const {
  return weight.y() == 0 && std::all_of(loads.begin(), loads.end(), [](const auto& load) {
           return load.force.y() == 0 && load.couple == 0;
         });
}

TipFrame tip_frame(const PlanarCantilever& rod) {
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
  TipFrame frame;
  frame.axis_angle = std::atan2(last.y(), last.x());
  frame.weight = into_frame(rod.weight, frame.axis_angle);
  for (auto load = rod.loads.rbegin(); load != rod.loads.rend(); ++load) {
    frame.loads.push_back({1 - load->at, into_frame(load->force, frame.axis_angle), load->couple});
  }
  return frame;
}

double total_load(const PlanarCantilever& rod) {
  double load = rod.weight.norm();
  for (const auto& l : rod.loads) load += l.force.norm() + std::abs(l.couple);
  return load;
}

TipShot shoot(const TipFrame& frame, double start, double tolerance) {
  std::vector<TipState> states;
  if (!integrate(frame, start, tolerance, {1.0}, states, true)) return {NAN, NAN};
  return {states.back()[psi], states.back()[psi_change]};
}

double shoot_angle(const TipFrame& frame, double start, double tolerance) {
  std::vector<TipState> states;
  return integrate(frame, start, tolerance, {1.0}, states, false) ? states.back()[psi] : NAN;
}

PlanarSamples sample(const TipFrame& frame, double start, double tolerance,
                     const std::vector<double>& distances) {
  std::vector<double> stops;
  stops.reserve(distances.size() + 1);
  for (const double s : distances) stops.push_back(1 - s);
  stops.push_back(1);
  std::sort(stops.begin(), stops.end());
  std::vector<TipState> states;
  PlanarSamples samples(static_cast<Eigen::Index>(distances.size()));
  if (!integrate(frame, start, tolerance, stops, states, false)) {
    samples.points.setConstant(NAN);
    samples.angle.setConstant(NAN);
    samples.curvature.setConstant(NAN);
    return samples;
  }
  const TipState& clamp = states.back();
  const double cosine = std::cos(frame.axis_angle);
  const double sine = std::sin(frame.axis_angle);
  // The clamp's tangent has the angle 0 up to the whole turns of the rod.
  const double turns =
      2 * std::numbers::pi * std::round((clamp[psi] + frame.axis_angle) / (2 * std::numbers::pi));
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const auto at = std::lower_bound(stops.begin(), stops.end(), 1 - distances[i]);
    const TipState& state = states[static_cast<std::size_t>(at - stops.begin())];
    const double dx = state[x] - clamp[x];
    const double dy = state[y] - clamp[y];
    const auto column = static_cast<Eigen::Index>(i);
    samples.points.col(column) << cosine * dx - sine * dy, sine * dx + cosine * dy;
    samples.angle[column] = state[psi] + frame.axis_angle - turns;
    samples.curvature[column] = -state[psi_rate];
  }
  return samples;
}

Energies energies(const PlanarCantilever& rod, const TipFrame& frame, double start,
                  double tolerance) {
  std::vector<TipState> states;
  if (!integrate(frame, start, tolerance, {1.0}, states, false)) return {NAN, NAN, NAN};
  Energies energies;
  energies.bending = states.back()[bending];
  energies.gravity = states.back()[gravity];
  std::vector<double> load_points;
  for (const auto& load : rod.loads) load_points.push_back(load.at);
  const PlanarSamples at_loads = sample(frame, start, tolerance, load_points);
  for (std::size_t j = 0; j < rod.loads.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    energies.load -= rod.loads[j].force.dot(at_loads.points.col(column)) +
                     rod.loads[j].couple * at_loads.angle[column];
  }
  return energies;
}

}  // namespace dlo::energy_model
