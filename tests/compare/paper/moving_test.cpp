#include "paper/moving.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "paper/moving_tables.hpp"

namespace dlo::compare {
namespace {

constexpr double weight_of_a_point = 0.00892;  // Table 1

MovingRun run(Movement movement, bool horizontal, MovingVariant variant,
              const MovingAssumptions& choices = {}) {
  return run_moving_experiment({movement, horizontal, variant}, choices);
}

TEST(MovingExperiment, AtRestTheGripperCarriesTheWeight) {
  const MovingAssumptions still{.angle = 0};
  for (const bool horizontal : {false, true}) {
    const MovingRun held = run(Movement::rotation, horizontal, MovingVariant::dynamic, still);
    ASSERT_EQ(held.status, MovingStatus::finished);
    EXPECT_NEAR(held.final_net_force, 10 * weight_of_a_point, 1e-9);
    if (horizontal) continue;
    // The gripper of a hanging rod carries the two points above it from below. The cubic law has no
    // stiffness when straight, so these points lean until c_b angle^2 is of the order of the
    // weight. This rotates the springs' forces by angles of that order.
    const double angle_squared = 4 * weight_of_a_point / 3776.21457;
    EXPECT_NEAR(held.final_force / held.final_net_force, 1, 2 * angle_squared);
  }
}

// Balance of forces and moments with P_i at i L: f_2 + f_3 = 10 w and 2 f_2 + 3 f_3 = 45 w, so
// f_2 = -15 w and f_3 = 25 w.
TEST(MovingExperiment, SpringsOfAHorizontalRodPullAgainstEachOther) {
  const MovingRun held = run(Movement::rotation, true, MovingVariant::dynamic, {.angle = 0});
  // The rod sags by a few degrees, which shortens the lever arms by less than 2 %.
  EXPECT_LT(held.final_force, 40 * weight_of_a_point);
  EXPECT_GT(held.final_force, 0.98 * 40 * weight_of_a_point);
}

TEST(MovingExperiment, NeedsMoreStepsExactlyIfSomeWereScaledDown) {
  for (const double start_offset : {0.0, 1.0}) {
    for (const MovingVariant variant : {MovingVariant::basic, MovingVariant::relative,
                                        MovingVariant::dynamic, MovingVariant::dynamic_absolute}) {
      const MovingRun moved =
          run(Movement::uniform, false, variant, {.start_offset = start_offset});
      ASSERT_EQ(moved.status, MovingStatus::finished);
      const long scaled_down = moved.damped_steps + moved.limited_steps;
      EXPECT_GE(moved.steps, nominal_moving_steps);
      EXPECT_LE(moved.steps - nominal_moving_steps, scaled_down);
      EXPECT_EQ(moved.steps == nominal_moving_steps, scaled_down == 0);
      EXPECT_TRUE(variant != MovingVariant::basic || scaled_down == 0);
    }
  }
}

// Formula 19 is Stoermer-Verlet for points of mass m* with damping rate (1 - c_h)/dt.
TEST(MovingReading, IsThatOfTable1) {
  const force_model::StepOptions options = moving_step_options(MovingVariant::dynamic, {});
  const PointParameters reading = point_parameters(options.c_F, options.c_h);
  EXPECT_NEAR(1e3 * reading.mass, 1.513, 1e-3);
  EXPECT_NEAR(reading.damping_rate, 200, 1e-9);
  EXPECT_NEAR(point_parameters(options.c_F, 0).damping_rate, 4000, 1e-9);
}

TEST(MovingReference, HoldsTheWeightBeforeAndAfterTheMovement) {
  const MovingReference reference = moving_reference({Movement::uniform, false, {}}, {});
  ASSERT_TRUE(reference.converged) << reference.message;
  EXPECT_LT(reference.energy_error, 1e-3);
  ASSERT_EQ(reference.frames.size(), reference.points.size());
  EXPECT_LT((reference.forces.back() - Eigen::Vector3d(0, moving_weight(), 0)).norm(), 1e-5);
  // At the end the hanging rod has been displaced as far as its gripper.
  const Eigen::RowVectorXd across = reference.points.back().row(0);
  EXPECT_LT((across.array() - MovingAssumptions{}.distance).abs().maxCoeff(), 1e-5);
  const MovingError relative =
      moving_error({Movement::uniform, false, MovingVariant::relative}, {}, reference);
  const MovingError dynamic =
      moving_error({Movement::uniform, false, MovingVariant::dynamic}, {}, reference);
  EXPECT_LT(dynamic.shape_rms, relative.shape_rms);
  EXPECT_LT(dynamic.force_rms, relative.force_rms);
  EXPECT_LE(dynamic.shape_rms, dynamic.shape_max);
}

TEST(MovingReport, PutsPrintedNumbersBesideItsOwn) {
  std::vector<MovingRow> rows = moving_rows();
  const auto printed =
      std::count_if(rows.begin(), rows.end(), [](const auto& row) { return row.printed; });
  EXPECT_EQ(printed, 11);
  EXPECT_EQ(rows.size(), 26U);
  EXPECT_EQ(rows[0].printed->steps, 116121);
  EXPECT_EQ(rows[2].experiment.variant, MovingVariant::dynamic_absolute);
  // If all results equal the printed values, the distance from the printed values is zero.
  for (MovingRow& row : rows) {
    if (!row.printed) continue;
    row.run = {.status = MovingStatus::finished,
               .steps = row.printed->steps,
               .damped_steps = row.printed->damped_steps,
               .limited_steps = row.printed->limited_steps,
               .average_force = row.printed->average_force};
  }
  const MovingAgreement same = moving_agreement(rows);
  EXPECT_DOUBLE_EQ(same.force_factor, 1);
  EXPECT_EQ(same.matching_counters, 33);
  EXPECT_EQ(same.counters, 33);
  rows[0].run.status = MovingStatus::too_many_steps;
  EXPECT_TRUE(std::isinf(moving_agreement(rows).force_factor));
}

}  // namespace
}  // namespace dlo::compare
