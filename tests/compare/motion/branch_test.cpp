#include "motion/branch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace dlo::compare {
namespace {

constexpr double missed_step = 1.0 / 512;

/// Whether two shapes show the end of the branch. The later shape is at a fraction `share` of the
/// missed step before the end, and the earlier one precedes it by `way`.
bool shows_end(const std::function<BranchSample(double)>& shape_before_end, double way,
               double share) {
  BranchSample last = shape_before_end(share * missed_step);
  BranchSample before = shape_before_end(share * missed_step + way);
  last.at = 1;
  before.at = 1 - way;
  return branch_ends_before(before, last, missed_step);
}

BranchSample sample_with_eigenvalue(double curvature) { return {.smallest_eigenvalue = curvature}; }

BranchSample sample_with_contact_force(double force) {
  BranchSample witness{.smallest_eigenvalue = 0.7};
  witness.contacts.resize(2);
  witness.contacts[0].force = Eigen::Vector3d(0, 3, 0);
  witness.contacts[1].force = Eigen::Vector3d(0, force, 0);
  return witness;
}

TEST(BranchWitness, ShowsFoldsBifurcationsAndLettingGo) {
  for (const double way : {missed_step, 8 * missed_step, 0.125, 1.0}) {
    for (const double share : {0.01, 0.5, 1.0}) {
      EXPECT_TRUE(shows_end([](double left) { return sample_with_eigenvalue(3 * std::sqrt(left)); },
                            way, share));
      EXPECT_TRUE(
          shows_end([](double left) { return sample_with_eigenvalue(2 * left); }, way, share));
      EXPECT_TRUE(
          shows_end([](double left) { return sample_with_contact_force(0.2 * left); }, way, share));
    }
  }
}

// A branch end that is this far beyond the missed step does not explain why the step was missed.
TEST(BranchWitness, ShowsNoEndThatIsFarAway) {
  constexpr double far = 0.1;
  for (const double way : {missed_step, 8 * missed_step, 0.125, 1.0}) {
    EXPECT_FALSE(shows_end(
        [](double left) { return sample_with_eigenvalue(3 * std::sqrt(left + far)); }, way, 1));
    EXPECT_FALSE(
        shows_end([](double left) { return sample_with_eigenvalue(2 * (left + far)); }, way, 1));
    EXPECT_FALSE(
        shows_end([](double left) { return sample_with_contact_force(left + far); }, way, 1));
    EXPECT_FALSE(shows_end([](double left) { return sample_with_eigenvalue(1 - left); }, way, 1));
    EXPECT_FALSE(shows_end([](double /*left*/) { return BranchSample{}; }, way, 1));
  }
}

// Forces of different contacts must not be compared.
TEST(BranchWitness, ComparesTheSameContactsOnly) {
  BranchSample last = sample_with_contact_force(1e-9);
  BranchSample before = sample_with_contact_force(1);
  last.at = 1;
  EXPECT_TRUE(branch_ends_before(before, last, missed_step));
  before.contacts.resize(1);
  EXPECT_FALSE(branch_ends_before(before, last, missed_step));
}

}  // namespace
}  // namespace dlo::compare
