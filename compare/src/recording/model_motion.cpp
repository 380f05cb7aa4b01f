#include "recording/model_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace dlo::compare {
namespace {

/// Lagrange's weights of four neighbours among values at 0, 1, .. count - 1.
struct Neighbours {
  Eigen::Index first = 0;
  std::array<double, 4> weights{};
};

Neighbours neighbours(double at, Eigen::Index count) {
  const auto last = static_cast<double>(count - 1);
  const double x = std::clamp(at, 0.0, last);
  Neighbours result;
  result.first =
      std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::floor(x)) - 1, 0, count - 4);
  const double t = x - static_cast<double>(result.first);
  result.weights = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
                    -t * (t - 1) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6};
  return result;
}

}  // namespace

ModelMotion::ModelMotion(double begin, double end, double length,
                         std::vector<Eigen::Matrix3Xd> frames)
    : begin_(begin), end_(end), length_(length), frames_(std::move(frames)) {}

Eigen::Vector3d ModelMotion::at(double time, double arc_length) const {
  const auto count = static_cast<Eigen::Index>(frames_.size());
  const Eigen::Index points = frames_.front().cols();
  const Neighbours in_time =
      neighbours((time - begin_) / (end_ - begin_) * static_cast<double>(count - 1), count);
  const Neighbours along =
      neighbours(arc_length / length_ * static_cast<double>(points - 1), points);
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::Matrix3Xd& frame = frames_[static_cast<std::size_t>(in_time.first + i)];
    for (Eigen::Index k = 0; k < 4; ++k) {
      result += in_time.weights[static_cast<std::size_t>(i)] *
                along.weights[static_cast<std::size_t>(k)] * frame.col(along.first + k);
    }
  }
  return result;
}

}  // namespace dlo::compare
