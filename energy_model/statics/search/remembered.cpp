#include "search/remembered.hpp"

#include <utility>

namespace dlo::energy_model {

void Remembered::remember(const SpanSolution& found, const PlacedSpan& placed) {
  before = std::exchange(last, {});
  before.factor = nullptr;
  frame = placed.frame;
  if (!succeeded(found.status) && !found.is_singular_point()) return;
  last = {found.model, found.x, found.multipliers, found.factor};
  point = found.at_x();
}

TangentField Remembered::field(const PlacedSpan& placed) const {
  const Eigen::Matrix3d turn = placed.frame * frame.transpose();
  const bool rolls = placed.span.has_material_directors() && !planar();
  return [model = last.model, point = point, turn, rolls](const Eigen::VectorXd& s) {
    StartShape shape(turn * point->tangents());
    if (rolls) shape.roll = roll_of(point->tangents(), point->d1());
    const Eigen::VectorXd& nodes = model->nodes();
    if (s.size() == nodes.size() && s == nodes) return shape;
    StartShape nearest(Eigen::Matrix3Xd(3, s.size()), Eigen::VectorXd(rolls ? s.size() : 0));
    for (Eigen::Index q = 0; q < s.size(); ++q) {
      Eigen::Index at = 0;
      (nodes.array() - s[q]).abs().minCoeff(&at);
      nearest.tangents.col(q) = shape.tangents.col(at);
      if (rolls) nearest.roll[q] = shape.roll[at];
    }
    return nearest;
  };
}

}  // namespace dlo::energy_model
