// A payload that hangs from a thin line, carried to the side and set down at rest: against a chain
// of rigid links with springs in its joints, in their angles, by Runge and Kutta's rule.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dlo/energy_model/dynamics.hpp"
#include "runge_kutta.hpp"

namespace dlo::energy_model {
namespace {

constexpr double weight_per_mass = 9.81;  // m/s^2
constexpr double line_mass = 0.02;        // kg on 1 m
constexpr double carried_mass = 0.5;      // kg
constexpr double line_stiffness_EI = 1e-5;
constexpr double carried_way = 0.6;  // m
constexpr double carrying_time = 2;  // s
constexpr double last_time = 4;      // s

/// Motion of the pin from rest to rest, with a smooth acceleration.
struct CarriedPin {
  double place = carried_way;
  double velocity = 0;
  double acceleration = 0;

  explicit CarriedPin(double time) {
    if (time >= carrying_time) return;
    const double phase = 2 * std::numbers::pi * time / carrying_time;
    const double speed = carried_way / carrying_time;
    place = speed * time - carried_way / (2 * std::numbers::pi) * std::sin(phase);
    velocity = speed * (1 - std::cos(phase));
    acceleration = speed * 2 * std::numbers::pi / carrying_time * std::sin(phase);
  }
};

/// Links of equal length h; angles from the vertical, then their rates.
class RigidLinks {
 public:
  explicit RigidLinks(Eigen::Index links) : h_(1.0 / static_cast<double>(links)) {
    Eigen::VectorXd masses = Eigen::VectorXd::Constant(links, line_mass * h_);
    masses[links - 1] = line_mass * h_ / 2 + carried_mass;
    below_.resize(links);
    double sum = 0;
    for (Eigen::Index i = links - 1; i >= 0; --i) below_[i] = sum += masses[i];
    state_.setZero(2 * links);
  }

  void advance(double to, double longest_step) {
    const int steps = static_cast<int>(std::ceil((to - time_) / longest_step));
    const double dt = (to - time_) / steps;
    const auto rate = [this](double t, const Eigen::VectorXd& state) { return rates(t, state); };
    for (int k = 0; k < steps; ++k) state_ = test::runge_kutta(rate, time_ + k * dt, state_, dt);
    time_ = to;
  }

  [[nodiscard]] Eigen::Vector3d payload() const {
    const auto angles = state_.head(below_.size()).array();
    return {CarriedPin(time_).place + h_ * angles.sin().sum(), -h_ * angles.cos().sum(), 0};
  }

 private:
  /// Lagrange's equations, over h: sum_j m_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) h
  ///     = -m_ii (g sin(a_i) + X'' cos(a_i)) + moments of the joints / h,
  /// m_ij what hangs below both links.
  [[nodiscard]] Eigen::VectorXd rates(double time, const Eigen::VectorXd& state) const {
    const Eigen::Index n = below_.size();
    const auto a = state.head(n);
    const auto rate = state.tail(n);
    const double push = CarriedPin(time).acceleration;
    Eigen::MatrixXd inertia(n, n);
    Eigen::VectorXd force(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double before = i > 0 ? a[i] - a[i - 1] : 0;
      const double after = i + 1 < n ? a[i + 1] - a[i] : 0;
      force[i] = -below_[i] * (weight_per_mass * std::sin(a[i]) + push * std::cos(a[i])) +
                 line_stiffness_EI / (h_ * h_) * (after - before);
      for (Eigen::Index j = 0; j < n; ++j) {
        const double mass = below_[std::max(i, j)] * h_;
        inertia(i, j) = mass * std::cos(a[i] - a[j]);
        force[i] -= mass * std::sin(a[i] - a[j]) * rate[j] * rate[j];
      }
    }
    Eigen::VectorXd result(2 * n);
    result << rate, inertia.ldlt().solve(force);
    return result;
  }

  double h_;
  double time_ = 0;
  Eigen::VectorXd below_;  // mass below a link's upper end [kg]
  Eigen::VectorXd state_;
};

MovingRod carried_payload(double damping) {
  MovingRod rod;
  rod.problem.length = 1;
  rod.problem.bending_stiffness = line_stiffness_EI;
  rod.problem.weight_per_length = {0, -line_mass * weight_per_mass, 0};
  rod.problem.grips = {{.at = 0, .position = Eigen::Vector3d::Zero()}};
  rod.problem.loads = {{1, {0, -carried_mass * weight_per_mass, 0}}};
  rod.inertia.mass_per_length = line_mass;
  rod.inertia.point_masses = {{1, carried_mass}};
  rod.material_damping = damping;
  rod.motions = {[](double time) {
    const CarriedPin pin(time);
    GripPose pose;
    pose.position.x() = pin.place;
    pose.velocity.x() = pin.velocity;
    pose.acceleration.x() = pin.acceleration;
    return pose;
  }};
  rod.breaks = {carrying_time};
  return rod;
}

// Damping is of the line's bending, which has 1e-6 of the energy: it swings alike with all of them.
TEST(PayloadMotion, IsThatOfAChainOfRigidLinks) {
  std::vector<double> times;
  for (int k = 1; k <= 21; ++k) times.push_back(last_time * k / 21);
  std::vector<Eigen::Vector3d> expected;
  RigidLinks links(24);
  for (const double time : times) {
    links.advance(time, 1e-3);
    expected.push_back(links.payload());
  }
  for (const double damping : {0.0, 0.01, 0.1}) {
    const Dynamics moved =
        simulate(carried_payload(damping), straight_rod(-Eigen::Vector3d::UnitY()), times);
    ASSERT_EQ(moved.status, SolveStatus::converged) << damping << ": " << moved.message;
    EXPECT_LT(moved.energy_error, 1e-5) << damping;
    for (std::size_t k = 0; k < times.size(); ++k) {
      const Eigen::Vector3d tip = moved.frames[k].sample(std::vector<double>{1.0}).points.col(0);
      EXPECT_LT((tip - expected[k]).norm(), 1e-3) << damping << ", " << times[k] << " s";
    }
  }
}

}  // namespace
}  // namespace dlo::energy_model
