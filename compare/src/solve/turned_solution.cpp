#include "solve/turned_solution.hpp"

namespace dlo::compare {

Solution turned_back(Solution solution, const PlaneTurn& turn) {
  const auto back = [&turn](Eigen::Vector3d& vector) { vector = turn.vectors_back(vector); };
  solution.shape.points = turn.points_back(solution.shape.points);
  if (solution.to_rest.cols() > 0) solution.to_rest = turn.vectors_back(solution.to_rest);
  for (GripperLoad& load : solution.grippers) {
    back(load.force);
    back(load.torque);
  }
  for (Eigen::Vector3d& force : solution.obstacles) back(force);
  return solution;
}

}  // namespace dlo::compare
