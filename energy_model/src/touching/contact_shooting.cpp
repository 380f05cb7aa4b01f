#include "touching/contact_shooting.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

namespace dlo::energy_model {
namespace {

constexpr int order = 20;  // of Taylor's series
// Of sqrt(n) times a step. The pendulum's nearest pole is more than one away, so that the remainder
// is below (0.3)^20 / 20.
constexpr double series_step = 0.3;
constexpr int most_newton_steps = 30;
constexpr double closed = 1e-9;

using Complex = std::complex<double>;

template <class T>
struct Arc {
  std::array<T, 4> state;  // x, y, angle, curvature
  std::array<T, 2> n;      // at its begin
};

/// One step of Taylor's series of x' = cos, y' = sin, angle' = kappa, kappa' = n_x sin - n_y cos.
template <class T>
void advance(Arc<T>& arc, const Eigen::Vector2d& w, const T& h) {
  std::array<T, order + 1> angle;
  std::array<T, order + 1> kappa;
  std::array<T, order + 1> c;
  std::array<T, order + 1> s;
  angle[0] = arc.state[2];
  kappa[0] = arc.state[3];
  c[0] = std::cos(angle[0]);
  s[0] = std::sin(angle[0]);
  for (std::size_t j = 0; j < order; ++j) {
    const double by = 1 / static_cast<double>(j + 1);
    angle[j + 1] = kappa[j] * by;
    T rate = arc.n[0] * s[j] - arc.n[1] * c[j];
    if (j > 0) rate += w.y() * c[j - 1] - w.x() * s[j - 1];
    kappa[j + 1] = rate * by;
    T ds = 0;
    T dc = 0;
    for (std::size_t i = 0; i <= j; ++i) {
      const T turn = static_cast<double>(i + 1) * angle[i + 1];
      ds += turn * c[j - i];
      dc -= turn * s[j - i];
    }
    s[j + 1] = ds * by;
    c[j + 1] = dc * by;
  }
  std::array<T, 4> end = {};
  for (std::size_t j = order; j-- > 0;) {
    const double by = 1 / static_cast<double>(j + 1);
    end[0] = (end[0] + c[j] * by) * h;
    end[1] = (end[1] + s[j] * by) * h;
  }
  for (std::size_t j = order + 1; j-- > 0;) {
    end[2] = end[2] * h + angle[j];
    end[3] = end[3] * h + kappa[j];
  }
  arc.state = {arc.state[0] + end[0], arc.state[1] + end[1], end[2], end[3]};
  arc.n[0] -= w.x() * h;
  arc.n[1] -= w.y() * h;
}

/// From the node of an arc on over a part of its length; f and reach may be complex.
template <class T>
std::array<T, 4> shoot(const TouchingShape& shape, std::size_t i, const std::array<T, 4>& start,
                       const T& force, const T& reach, const T& length) {
  const Eigen::Vector2d& w = shape.weight;
  const T begin = reach * (static_cast<double>(i) / static_cast<double>(shape.nodes.size()));
  Arc<T> arc{start, {w.x() * (reach - begin), w.y() * (reach - begin)}};
  const Eigen::Vector2d along(std::cos(shape.end_angle), std::sin(shape.end_angle));
  for (Eigen::Index k = 0; k < 2; ++k) {
    T& n = arc.n[static_cast<std::size_t>(k)];
    if (shape.contact != EndContact::none) n += force * shape.floor.normal[k];
    if (shape.contact == EndContact::lying) n += along.dot(w) * along[k] * (1.0 - reach);
  }
  const double rate = 1 + std::sqrt(w.norm() + std::abs(force)) + std::abs(start[3]);
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(length) * rate / series_step)));
  for (int step = 0; step < steps; ++step) advance<T>(arc, w, length / static_cast<double>(steps));
  return arc.state;
}

/// Residual and Jacobian of [kappa_0, nodes 1.., f, reach].
struct System {
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

Eigen::Index unknowns_of_end(EndContact contact) {
  if (contact == EndContact::none) return 0;
  return contact == EndContact::tip ? 1 : 2;
}

template <class T>
std::array<T, 4> end_miss(const TouchingShape& shape, const std::array<T, 4>& end) {
  const Floor& floor = shape.floor;
  return {end[3], floor.normal.x() * end[0] + floor.normal.y() * end[1] - floor.height,
          end[2] - shape.end_angle, T(0)};
}

System system_of(const TouchingShape& shape) {
  constexpr double tiny = 1e-30;  // of the complex step, whose derivative is exact
  const std::size_t arcs = shape.nodes.size();
  const auto size = static_cast<Eigen::Index>(4 * arcs) - 3 + unknowns_of_end(shape.contact);
  System system{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)};
  for (std::size_t i = 0; i < arcs; ++i) {
    const auto row = static_cast<Eigen::Index>(4 * i);
    const bool last = i + 1 == arcs;
    const Eigen::Index rows = last ? size - row : 4;
    for (int k = -1; k < 6; ++k) {
      std::array<Complex, 4> start;
      std::copy(shape.nodes[i].begin(), shape.nodes[i].end(), start.begin());
      Complex force = shape.force;
      Complex reach = shape.reach;
      Eigen::Index column = row - 3 + k;
      if (k >= 0 && k < 4) start[static_cast<std::size_t>(k)] += Complex(0, tiny);
      if (k == 4) force += Complex(0, tiny);
      if (k == 5) reach += Complex(0, tiny);
      if (k >= 4) column = static_cast<Eigen::Index>(4 * arcs) - 3 + k - 4;
      if (k >= 0 && (column < 0 || column >= size)) continue;
      std::array<Complex, 4> end =
          shoot<Complex>(shape, i, start, force, reach, reach / static_cast<double>(arcs));
      if (last) end = end_miss(shape, end);
      for (Eigen::Index r = 0; r < rows; ++r) {
        const auto e = static_cast<std::size_t>(r);
        if (k >= 0) {
          system.jacobian(row + r, column) += end[e].imag() / tiny;
        } else {
          system.residual[row + r] = end[e].real() - (last ? 0 : shape.nodes[i + 1][e]);
        }
      }
    }
    for (Eigen::Index r = 0; !last && r < 4; ++r) system.jacobian(row + r, row + 1 + r) -= 1;
  }
  return system;
}

void move(TouchingShape& shape, const Eigen::VectorXd& step, double share) {
  shape.nodes.front()[3] += share * step[0];
  Eigen::Index at = 1;
  for (std::size_t i = 1; i < shape.nodes.size(); ++i) {
    for (double& value : shape.nodes[i]) value += share * step[at++];
  }
  if (at < step.size()) shape.force += share * step[at++];
  if (at < step.size()) shape.reach += share * step[at];
}

}  // namespace

bool close_arcs(TouchingShape& shape) {
  System system = system_of(shape);
  ++shape.shots;
  shape.residual = system.residual.lpNorm<Eigen::Infinity>();
  shape.step = INFINITY;
  for (int steps = 0; steps < most_newton_steps; ++steps) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(system.jacobian);
    const Eigen::VectorXd step = -lu.solve(system.residual);
    if (!step.allFinite()) return false;
    const double length = step.lpNorm<Eigen::Infinity>();
    double share = 1;
    TouchingShape moved = shape;
    for (;; share /= 2) {
      ++shape.shots;
      moved = shape;
      move(moved, step, share);
      system = moved.reach > 0 && moved.reach < 2 ? system_of(moved) : System{};
      moved.residual = system.residual.size() > 0 ? system.residual.lpNorm<Eigen::Infinity>() : NAN;
      if (moved.residual < shape.residual || share < 1.0 / 64) break;
    }
    if (!(moved.residual < shape.residual)) {
      // Rounding: nothing is to be gained any more.
      shape.step = std::min(shape.step, length);
      shape.positive =
          lu.permutationP().determinant() * lu.matrixLU().diagonal().array().sign().prod() > 0;
      return shape.residual < closed;
    }
    shape = moved;
    shape.step = share * length;
  }
  return shape.residual < closed;
}

ArcState state_at(const TouchingShape& shape, double s) {
  if (s > shape.reach) {
    const ArcState end = state_at(shape, shape.reach);
    const double by = s - shape.reach;
    return {end[0] + by * std::cos(shape.end_angle), end[1] + by * std::sin(shape.end_angle),
            shape.end_angle, 0};
  }
  const auto arcs = static_cast<double>(shape.nodes.size());
  const double arc = std::clamp(std::floor(s / shape.reach * arcs), 0.0, arcs - 1);
  const auto i = static_cast<std::size_t>(arc);
  return shoot<double>(shape, i, shape.nodes[i], shape.force, shape.reach,
                       s - shape.reach * arc / arcs);
}

bool is_stable(const TouchingShape& shape, double margin) {
  const int count = 64 * static_cast<int>(shape.nodes.size());
  // Elements of length h err by h^2 q/12 = (6/64)^2/12 of a local rate q; 1e-3 is more.
  const Eigen::Vector2d& w = shape.weight;
  const bool lies = shape.contact == EndContact::lying;
  const Eigen::Vector2d along(std::cos(shape.end_angle), std::sin(shape.end_angle));
  // The rate q of eta^2, at the middle of an element.
  const auto stiffness = [&](bool in_plane, double s) {
    const ArcState at = state_at(shape, s);
    const Eigen::Vector2d t(std::cos(at[2]), std::sin(at[2]));
    Eigen::Vector2d n = w * (1 - s);
    if (s > shape.reach) return along.dot(n) - margin * (1 + std::abs(along.dot(n)));
    if (shape.contact != EndContact::none) n += shape.force * shape.floor.normal;
    if (lies) n += (along * along.dot(w) - w) * (1 - shape.reach);
    const double bent = in_plane ? 0 : at[3] * at[3];
    return n.dot(t) - bent - margin * (1 + std::abs(n.dot(t)) + bent);
  };
  for (const bool in_plane : {true, false}) {
    const double h = (in_plane ? shape.reach : 1) / count;
    // The eliminated unknowns leave a diagonal, and of the constraint a component and a^T K^-1 a.
    double diagonal = 0;
    double component = 0;
    double product = 0;
    int negative = 0;
    for (int e = 0; e < count; ++e) {
      const double s = (e + 0.5) * h;
      const double q = stiffness(in_plane, s);
      const double on = 1 / h + q * h / 3;
      const double off = -1 / h + q * h / 6;
      const double angle = state_at(shape, s)[2];
      const double lever =
          h / 2 * shape.floor.normal.dot(Eigen::Vector2d(-std::sin(angle), std::cos(angle)));
      if (e == 0) {
        diagonal = on;
        component = lever;
        continue;
      }
      diagonal += on;
      component += lever;
      negative += diagonal < 0 ? 1 : 0;
      product += component * component / diagonal;
      component = lever - off * component / diagonal;
      diagonal = on - off * off / diagonal;
    }
    if (!(in_plane && lies)) {
      negative += diagonal < 0 ? 1 : 0;
      product += component * component / diagonal;
    }
    // The constraint takes one negative direction away if a^T K^-1 a < 0.
    const bool held = in_plane && shape.contact != EndContact::none && product < 0;
    if (negative > (held ? 1 : 0)) return false;
  }
  return true;
}

}  // namespace dlo::energy_model
