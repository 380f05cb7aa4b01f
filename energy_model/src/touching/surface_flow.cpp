#include "touching/surface_flow.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <unsupported/Eigen/AutoDiff>

namespace dlo::energy_model {
namespace {

constexpr std::size_t series_order = 20;
// Of a step times the rate at which the shape changes: the remainder is (0.3)^20 of it.
constexpr double longest_rate = 0.3;
constexpr double flat = 1e-9;  // of curvature, in 1/l

/// A number and its derivatives by the cross-section at the begin.
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 12, 1>>;

template <class T>
using Series = std::array<T, series_order + 1>;
template <class T>
using VectorSeries = std::array<Eigen::Matrix<T, 3, 1>, series_order + 1>;

/// Coefficient j of the product a.b.
template <class T>
T product(const VectorSeries<T>& a, const VectorSeries<T>& b, std::size_t j) {
  T sum(0);
  for (std::size_t i = 0; i <= j; ++i) sum += (a[i].transpose() * b[j - i]).value();
  return sum;
}

template <class T>
FlowState<T> advance(const std::optional<Surface>& surface, const Eigen::Vector3d& weight, double h,
                     const FlowState<T>& state) {
  VectorSeries<T> r;
  VectorSeries<T> t;
  VectorSeries<T> v;
  VectorSeries<T> n;
  VectorSeries<T> across_t;
  VectorSeries<T> across_v;
  VectorSeries<T> normal;
  Series<T> pull;
  Series<T> pressed;
  const double bend = surface ? surface->bend() : 0;
  r[0] = state.template segment<3>(0);
  t[0] = state.template segment<3>(3);
  v[0] = state.template segment<3>(6);
  n[0] = state.template segment<3>(9);
  for (std::size_t j = 0; j < series_order; ++j) {
    const double by = 1 / static_cast<double>(j + 1);
    pull[j] = product(n, t, j) - product(v, v, j);
    Eigen::Matrix<T, 3, 1> bent = -n[j];
    for (std::size_t i = 0; i <= j; ++i) bent += pull[i] * t[j - i];
    Eigen::Matrix<T, 3, 1> fall = Eigen::Matrix<T, 3, 1>::Zero();
    if (j == 0) fall = -weight.cast<T>();
    if (surface) {
      across_t[j] = surface->across.cast<T>() * t[j];
      across_v[j] = surface->across.cast<T>() * v[j];
      if (bend > 0) {
        normal[j] =
            bend * (surface->across.cast<T>() *
                    (j == 0 ? Eigen::Matrix<T, 3, 1>(r[0] - surface->centre.cast<T>()) : r[j]));
      } else {
        normal[j] = Eigen::Matrix<T, 3, 1>::Zero();
        if (j == 0) normal[0] = surface->normal.cast<T>();
      }
      T along(0);  // of pull t.P t
      if (bend > 0) {
        for (std::size_t i = 0; i <= j; ++i) along += pull[i] * product(t, across_t, j - i);
      }
      pressed[j] = -(weight.cast<T>().transpose() * normal[j]).value() +
                   bend * (4.0 * product(n, across_t, j) - 3.0 * (product(v, across_v, j) + along));
      for (std::size_t i = 0; i <= j; ++i) fall -= pressed[i] * normal[j - i];
    }
    r[j + 1] = by * t[j];
    t[j + 1] = by * v[j];
    v[j + 1] = by * bent;
    n[j + 1] = by * fall;
  }
  FlowState<T> end = FlowState<T>::Zero();
  for (std::size_t j = series_order + 1; j-- > 0;) {
    FlowState<T> term;
    term << r[j], t[j], v[j], n[j];
    end = end * h + term;
  }
  return end;
}

int steps_of(const std::optional<Surface>& surface, const Eigen::Vector3d& weight, double length,
             const FlowState<double>& state) {
  const double turning = state.segment<3>(6).norm();
  const double pulled = state.segment<3>(9).norm();
  const double rate = 1 + turning + std::sqrt(pulled + weight.norm() * std::abs(length)) +
                      (surface ? surface->bend() : 0);
  return std::max(1, static_cast<int>(std::ceil(std::abs(length) * rate / longest_rate)));
}

template <class T>
FlowState<T> follow(const std::optional<Surface>& surface, const Eigen::Vector3d& weight,
                    double length, FlowState<T> state, int steps) {
  for (int step = 0; step < steps; ++step) {
    state = advance<T>(surface, weight, length / steps, state);
  }
  return state;
}

}  // namespace

double Surface::gap(const Eigen::Vector3d& r) const {
  const Eigen::Vector3d from = r - centre;
  return std::isfinite(radius) ? (across * from).norm() - radius : normal.dot(from);
}

Eigen::Vector3d Surface::outward(const Eigen::Vector3d& r) const {
  return std::isfinite(radius) ? Eigen::Vector3d((across * (r - centre)).normalized()) : normal;
}

Surface surface_of(const obstacle::Body& body, const Eigen::Vector3d& near) {
  const obstacle::Gap gap = body.gap(near);
  Surface surface;
  surface.normal = gap.gradient;
  surface.centre = near - gap.value * gap.gradient;
  // Both curvatures of a ball, the one of a cylinder are one over the distance to the core.
  const double bend =
      gap.hessian.norm() / (gap.hessian.trace() > 1.2 * gap.hessian.norm() ? std::sqrt(2.0) : 1.0);
  if (bend > flat) {
    const double distance = 1 / bend;
    surface.across = distance * gap.hessian + gap.gradient * gap.gradient.transpose();
    surface.centre = near - distance * gap.gradient;
    surface.radius = distance - gap.value;
  }
  return surface;
}

double pressure(const Surface& surface, const Eigen::Vector3d& weight,
                const FlowState<double>& state) {
  const Eigen::Vector3d t = state.segment<3>(3);
  const Eigen::Vector3d v = state.segment<3>(6);
  const Eigen::Vector3d n = state.segment<3>(9);
  const Eigen::Vector3d across_t = surface.across * t;
  return -weight.dot(surface.outward(state.head<3>())) +
         surface.bend() *
             (4 * n.dot(across_t) -
              3 * (v.dot(surface.across * v) + (n.dot(t) - v.squaredNorm()) * t.dot(across_t)));
}

FlowState<double> rate_of(const std::optional<Surface>& surface, const Eigen::Vector3d& weight,
                          const FlowState<double>& state) {
  const Eigen::Vector3d t = state.segment<3>(3);
  const Eigen::Vector3d v = state.segment<3>(6);
  const Eigen::Vector3d n = state.segment<3>(9);
  Eigen::Vector3d fall = -weight;
  if (surface) fall -= pressure(*surface, weight, state) * surface->outward(state.head<3>());
  FlowState<double> rate;
  rate << t, v, (n.dot(t) - v.squaredNorm()) * t - n, fall;
  return rate;
}

FlowState<double> flow(const std::optional<Surface>& surface, const Eigen::Vector3d& weight,
                       double length, const FlowState<double>& state) {
  return follow(surface, weight, length, state, steps_of(surface, weight, length, state));
}

Eigen::Matrix<double, 12, 12> transition(const std::optional<Surface>& surface,
                                         const Eigen::Vector3d& weight, double length,
                                         const FlowState<double>& state) {
  FlowState<Dual> start;
  for (Eigen::Index k = 0; k < start.size(); ++k) start[k] = Dual(state[k], 12, k);
  const FlowState<Dual> end =
      follow(surface, weight, length, start, steps_of(surface, weight, length, state));
  Eigen::Matrix<double, 12, 12> by_state;
  for (Eigen::Index k = 0; k < end.size(); ++k) by_state.row(k) = end[k].derivatives();
  return by_state;
}

}  // namespace dlo::energy_model
