// Tests of the objective of the energy model: its derivatives, and that its evaluation allocates no
// memory.

#include "strain/span_energy.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <random>

#include "../count_allocations.hpp"

namespace dlo::energy_model {
namespace {

/// Returns a span with two clamps, a pin between them, weight and loads. It is so soft that it has
/// bending layers at the clamps.
Span gripped_span(bool planar) {
  const double z = planar ? 0 : 1;
  Span span;
  span.planar = planar;
  span.start_direction = Eigen::Vector3d(1, 0.2, 0.1 * z).normalized();
  span.end_direction = Eigen::Vector3d(1, -0.4, 0.3 * z).normalized();
  span.holds = {{0.6, {0.4, -0.1, 0.1 * z}}, {1, {0.7, 0.1, 0}}};
  span.weight = {1, -30, 5 * z};
  span.loads = {{0.3, {1, 2, -z}}};
  return span;
}

/// Returns the span without clamps, held at 0.2 instead of its begin.
Span without_clamps(Span span) {
  span.start_direction.reset();
  span.end_direction.reset();
  span.twist.reset();
  span.principal_d1.reset();
  span.anchor = 0.2;
  return span;
}

Span free_span(bool planar) { return without_clamps(gripped_span(planar)); }

Span span_on_obstacle(bool planar) {
  Span span = gripped_span(planar);
  span.soft_obstacles = {
      {{0, obstacle::Body::half_space({0, 0.02, 0}, Eigen::Vector3d::UnitY())}, 500},
      {{1, obstacle::Body::sphere({0.3, 0.1, 0}, 0.25)}, 300}};
  return span;
}

/// Returns the span on a rigid obstacle, with a contact at one point and a contact interval across
/// a load.
Span touching_span(bool planar) {
  const double z = planar ? 0 : 0.3;
  Span span = gripped_span(planar);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.1, 1, z).normalized();
  const Span::Obstacle obstacle{0, obstacle::Body::half_space(-0.05 * normal, normal)};
  span.rigid_obstacles = {obstacle};
  span.contacts = {{obstacle, 0.15, 0.15}, {obstacle, 0.25, 0.45}};
  return span;
}

/// Returns the span in contact with a peg: at a point, along an interval across the load, and
/// beyond it at a point that does not slide.
Span span_on_peg(bool planar) {
  const double z = planar ? 0 : 0.3;
  Span span = gripped_span(planar);
  const Span::Obstacle peg{0,
                           obstacle::Body::cylinder({0.3, -0.2, 0}, {-0.1 * z, 0.3 * z, 1}, 0.15)};
  span.rigid_obstacles = {peg};
  span.contacts = {{peg, 0.15, 0.15}, {peg, 0.25, 0.45}, {peg, 0.7, 0.7, false}};
  return span;
}

/// Returns the span with clamps that both hold the rod's frame; a rod in the plane has no twist.
Span twisted_span(bool planar) {
  Span span = gripped_span(planar);
  span.twist = Span::Twist{0.7, {0.1, 0.9, 0.8}};
  return span;
}

/// Returns an intrinsically curved and, in space, twisted rod with a section and a clamp inside the
/// span that transmits torque.
Span natural_span(bool planar) {
  const double z = planar ? 0 : 1;
  Span span = gripped_span(planar);
  span.stiffness = {1, 1, 0.7};
  span.parts = {{0.25, 0.5, {2, 2, 1.1}, {0, -4, z}}};
  span.natural = {.coefficients = {{2, z, 1.5 * z}, {-0.7, 0.4 * z, -0.6 * z}}};
  span.holds[0].direction = Eigen::Vector3d(1, 0.1, 0.2 * z).normalized();
  if (!planar) span.twist = Span::Twist{0.7, {0.1, 0.9, 0.8}};
  return span;
}

Span free_natural_span(bool planar) { return without_clamps(natural_span(planar)); }

/// Returns a strip with three different stiffnesses and a section with three others; in space its
/// principal axes differ from those of the span.
Span strip_span(bool planar) {
  Span span = natural_span(planar);
  span.stiffness = {1, 3, 0.7};
  span.parts[0].stiffness = {2, 0.4, 1.1};
  if (!planar) span.principal_d1 = Eigen::Vector3d(-0.1, 0.8, 0.6);
  return span;
}

Span free_strip_span(bool planar) { return without_clamps(strip_span(planar)); }

/// Returns the span with two line loads that overlap, in addition to the weight.
Span line_loaded_span(bool planar) {
  const double z = planar ? 0 : 1;
  Span span = gripped_span(planar);
  span.line_loads = {{0.1, 0.5, {3, -9, z}, {-5, 7, -z}}, {0.4, 1, {0, 8, z}, {0, 8, z}}};
  return span;
}

/// Returns an intrinsically curved span with two couples and a force, free to rotate at both ends.
Span span_with_couple(bool planar) {
  Span span = free_natural_span(planar);
  span.loads[0].couple = 3;
  span.loads.push_back({0.8, {0, 0, 0}, -2});
  return span;
}

struct Case {
  Span (*make)(bool planar);
  bool planar;

  [[nodiscard]] Span span() const { return make(planar); }
};

class Objective : public testing::TestWithParam<Case> {};

void expect_derivatives(SpanEnergy& model) {
  const Eigen::Index n = model.size();
  const Eigen::Index m = model.constraints();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(n, [&] { return uniform(random); });
  const Eigen::VectorXd mu = Eigen::VectorXd::NullaryExpr(m, [&] { return uniform(random); });

  SpanPoint here = model.evaluated(x);
  Eigen::MatrixXd hessian;
  model.hessian(here, mu, hessian);
  const double h = 1e-5;
  const double scale = 1 + hessian.norm();
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::VectorXd aside = x;
    aside[k] += h;
    const SpanPoint after = model.evaluated(aside);
    aside[k] -= 2 * h;
    const SpanPoint before = model.evaluated(aside);
    EXPECT_NEAR((after.energy - before.energy) / (2 * h), here.gradient[k], 1e-8 * scale);
    const Eigen::VectorXd slope = (after.residual - before.residual) / (2 * h);
    EXPECT_LT((slope - here.jacobian.col(k)).norm(), 1e-8 * scale);
    const Eigen::VectorXd lagrangian_after = after.gradient - after.jacobian.transpose() * mu;
    const Eigen::VectorXd lagrangian_before = before.gradient - before.jacobian.transpose() * mu;
    const Eigen::VectorXd curve = (lagrangian_after - lagrangian_before) / (2 * h);
    EXPECT_LT((curve - hessian.col(k)).norm(), 1e-7 * scale) << "unknown " << k;
  }
}

// Small, medium and large numbers of unknowns use different implementations of matrix products.
TEST_P(Objective, HasTheDerivativesOfItsValue) {
  for (const int terms : {3, 6, 12}) {
    if (test::sanitized && terms > 6) continue;
    SpanEnergy model(GetParam().span(), terms);
    expect_derivatives(model);
  }
}

#ifdef DLO_COUNTS_ALLOCATIONS
class ObjectiveWithoutObstacles : public Objective {};

TEST_P(ObjectiveWithoutObstacles, DoesNotAllocate) {
  SpanEnergy model(GetParam().span(), 12);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.size());
  const Eigen::VectorXd mu = Eigen::VectorXd::Ones(model.constraints());
  Eigen::MatrixXd hessian(model.size(), model.size());
  SpanPoint point = model.evaluated(x);
  model.hessian(point, mu, hessian);
  const long before = allocations;
  for (int i = 1; i < 3; ++i) {
    x[0] = i;
    model.evaluate(x, point);
    model.hessian(point, mu, hessian);
  }
  EXPECT_EQ(allocations, before);
}

INSTANTIATE_TEST_SUITE_P(Spans, ObjectiveWithoutObstacles,
                         testing::Values(Case{gripped_span, true}, Case{gripped_span, false},
                                         Case{free_span, true}, Case{free_span, false},
                                         Case{twisted_span, false}, Case{natural_span, true},
                                         Case{natural_span, false}, Case{free_natural_span, false},
                                         Case{strip_span, true}, Case{strip_span, false},
                                         Case{line_loaded_span, true},
                                         Case{line_loaded_span, false}));
#endif

INSTANTIATE_TEST_SUITE_P(
    Spans, Objective,
    testing::Values(Case{gripped_span, true}, Case{gripped_span, false}, Case{free_span, true},
                    Case{free_span, false}, Case{span_on_obstacle, true},
                    Case{span_on_obstacle, false}, Case{touching_span, true},
                    Case{touching_span, false}, Case{span_on_peg, true}, Case{span_on_peg, false},
                    Case{twisted_span, false}, Case{natural_span, true}, Case{natural_span, false},
                    Case{free_natural_span, true}, Case{free_natural_span, false},
                    Case{strip_span, true}, Case{strip_span, false}, Case{free_strip_span, false},
                    Case{line_loaded_span, true}, Case{line_loaded_span, false},
                    Case{span_with_couple, true}));

}  // namespace
}  // namespace dlo::energy_model
