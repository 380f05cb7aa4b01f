#include "recording/frame_shapes.hpp"

#include <cmath>
#include <utility>
#include <vector>

namespace dlo::compare {
namespace {

constexpr int whole_rod_samples = 201;

Shape rod_shape(const ModelMotion& model, double time, std::vector<double> arc_length) {
  Shape shape{.arc_length = std::move(arc_length), .points = {}};
  shape.points.resize(3, static_cast<Eigen::Index>(shape.arc_length.size()));
  for (Eigen::Index i = 0; i < shape.points.cols(); ++i) {
    shape.points.col(i) = model.at(time, shape.arc_length[static_cast<std::size_t>(i)]);
  }
  return shape;
}

}  // namespace

FrameShapes frame_shapes(const MarkerMotion& recorded, const ModelMotion& model, double time,
                         double length, double lag) {
  FrameShapes result{.time = time};
  std::vector<Eigen::Vector3d> points;
  for (const MarkerPosition& at : recorded.positions) {
    if (at.time != time) continue;
    points.push_back(at.position);
    result.recorded.arc_length.push_back(at.arc_length);
  }
  result.recorded.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.recorded.points.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  result.on_rod = rod_shape(model, time, result.recorded.arc_length);
  result.rod = rod_shape(model, time, equal_arc_lengths(length, whole_rod_samples));
  if (std::isfinite(lag)) {
    result.rod_at_other_time =
        rod_shape(model, time - lag, equal_arc_lengths(length, whole_rod_samples));
  }
  return result;
}

}  // namespace dlo::compare
