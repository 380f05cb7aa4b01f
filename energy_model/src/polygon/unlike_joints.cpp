#include "polygon/unlike_joints.hpp"

#include <cmath>

#include "base/require.hpp"
#include "polygon/fold_angle.hpp"

namespace dlo::energy_model {

void require_unlike_joints(const char* problem, JointLaw law, const Eigen::VectorXd& stiffnesses,
                           const Eigen::VectorXd& natural_turns, Eigen::Index n) {
  const auto require_each = [&](const Eigen::VectorXd& numbers, const char* size) {
    require(numbers.size() == 0 || numbers.size() == n - 1, problem, size,
            static_cast<double>(numbers.size()), "0 or the number of joints");
  };
  require_each(stiffnesses, "size of stiffnesses");
  require_each(natural_turns, "size of natural_turns");
  for (const double stiffness : stiffnesses) {
    require_positive(problem, "stiffness of a joint", stiffness);
  }
  require(natural_turns.size() == 0 || law != JointLaw::paper, problem, "size of natural_turns",
          static_cast<double>(natural_turns.size()), "0 for the paper's law");
  for (const double turn : natural_turns) {
    require(std::abs(turn) < fold_angle, problem, "natural turn", turn, "in (-3, 3) rad");
  }
}

}  // namespace dlo::energy_model
