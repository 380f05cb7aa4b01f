#include "shape_options.hpp"

#include <Eigen/Geometry>

#include "dlo/compare/quantity.hpp"
#include "dlo/compare/shape_file.hpp"
#include "output.hpp"

namespace dlo::cli {

void ShapeOptions::add_to(CLI::App& command) {
  const std::string group = "Shape files";
  command.add_option("--unit", unit_, "what the numbers are in: m, cm, mm or um")
      ->check(CLI::IsMember({"m", "cm", "mm", "um"}))
      ->capture_default_str()
      ->group(group);
  command
      .add_flag(
          "--register{rigid}", pose_,
          "the file's frame is unknown: find it. --register=upright if its vertical is known, "
          "--register=translation if all directions are")
      ->check(CLI::IsMember(compare::pose_names()))
      ->group(group);
  command
      .add_option(
          "--arc-lengths", arc_lengths_,
          "of the points: the file's column s, chord lengths of a whole rod, nearest points "
          "of the reference, or auto")
      ->check(CLI::IsMember(compare::arc_lengths_names()))
      ->capture_default_str()
      ->group(group);
}

compare::MeasuredShape ShapeOptions::load(const std::string& path) const {
  return compare::load_shape(path,
                             compare::parse_quantity("1 " + unit_, compare::Dimension::length));
}

std::string direction_text(const compare::Alignment& alignment) {
  return alignment.reversed ? "from arc length l to 0" : "from arc length 0 to l";
}

std::string pose_text(const compare::RigidMotion& pose) {
  const Eigen::AngleAxisd turn(pose.rotation);
  std::string out;
  // Adding zero turns -0 into 0.
  const Eigen::Vector3d axis = turn.axis().array() + 0.0;
  const Eigen::Vector3d move = pose.translation.array() + 0.0;
  append(out,
         "turned {:.3f} deg about [{:.4f}, {:.4f}, {:.4f}], then moved [{:.6g}, {:.6g}, {:.6g}] m",
         turn.angle() * 57.29577951308232, axis.x(), axis.y(), axis.z(), move.x(), move.y(),
         move.z());
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
