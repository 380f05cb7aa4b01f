#include "format/alignment_output.hpp"

#include <Eigen/Geometry>
#include <utility>

#include "format/solution_output.hpp"

namespace dlo::cli {

std::string range_text(const compare::Alignment& alignment, double length) {
  double from = alignment.shape.arc_length.front();
  double to = alignment.shape.arc_length.back();
  const double near = 1e-4 * length;
  const bool whole = from <= near && to >= length - near;
  if (whole) return alignment.reversed ? "from arc length l to 0" : "from arc length 0 to l";
  if (alignment.reversed) std::swap(from, to);
  return fmt::format("from s = {:.4g} to {:.4g} m", from, to);
}

std::string pose_text(const compare::RigidMotion& pose, double length) {
  const Eigen::AngleAxisd turn(pose.rotation);
  std::string out;
  const Eigen::Vector3d axis = shown(turn.axis(), 1);
  const Eigen::Vector3d move = shown(pose.translation, length);
  append(
      out,
      "rotated by {:.3f} deg about [{:.4f}, {:.4f}, {:.4f}], then moved [{:.6g}, {:.6g}, {:.6g}] m",
      turn.angle() * 57.29577951308232, axis.x(), axis.y(), axis.z(), move.x(), move.y(), move.z());
  return out;
}

Json to_json(const compare::Alignment& alignment) {
  Json rotation = Json::array();
  for (Eigen::Index i = 0; i < 3; ++i) {
    rotation.push_back(to_json(Eigen::Vector3d(alignment.pose.rotation.row(i).transpose())));
  }
  return {{"reversed", alignment.reversed},
          {"arc_lengths", compare::to_string(alignment.arc_lengths)},
          {"pose",
           {{"rotation", std::move(rotation)},
            {"translation_m", to_json(alignment.pose.translation)}}}};
}

}  // namespace dlo::cli
