#include "kirchhoff/frame_joints.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

std::vector<FrameJoint> frame_joints(const RodSpan& span, const RodMesh& mesh) {
  std::vector<FrameJoint> joints;
  const auto stiffness = [&](Eigen::Index i) {
    Eigen::Vector3d own = mesh.section_of(i).stiffness();
    if (span.round()) own.z() = 0;  // no torque twists a round rod here
    return own;
  };
  const auto natural = [&](double s) {
    return span.natural ? span.natural(s) : Eigen::Vector3d::Zero().eval();
  };
  const auto to_clamp = [&](Eigen::Index i, Eigen::Index clamp, bool before) {
    const double h = mesh.width(i) / 2;
    const double middle = before ? mesh.s[i + 1] - h / 2 : mesh.s[i] + h / 2;
    joints.push_back({before ? i : clamp, before ? clamp : i, before ? i + 1 : i, h, stiffness(i),
                      natural(middle)});
  };
  for (Eigen::Index i = 0; i <= mesh.intervals(); ++i) {
    const RodSpan::Clamp* clamp = span.clamp_at(mesh.s[i]);
    if (clamp != nullptr) {
      const Eigen::Index frame = mesh.intervals() + (clamp - span.clamps.data());
      if (i > 0) to_clamp(i - 1, frame, true);
      if (i < mesh.intervals()) to_clamp(i, frame, false);
    } else if (i > 0 && i < mesh.intervals()) {
      const double before = mesh.width(i - 1) / 2;
      const double after = mesh.width(i) / 2;
      const Eigen::Vector3d compliance =
          before * stiffness(i - 1).cwiseInverse() + after * stiffness(i).cwiseInverse();
      joints.push_back({i - 1, i, i, before + after, (before + after) * compliance.cwiseInverse(),
                        natural(mesh.s[i] + (after - before) / 2)});
    }
  }
  return joints;
}

Eigen::Quaterniond clamp_frame(const RodSpan& span, std::size_t clamp, double turn) {
  const Eigen::Quaterniond frame =
      clamp == 0 ? Eigen::Quaterniond(span.first_frame)
                 : Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                                      span.clamps[clamp].direction);
  return frame * Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
}

std::vector<double> adjacent_interval_turns(const RodSpan& span, const RodMesh& mesh,
                                            const std::vector<Eigen::Quaterniond>& frames) {
  std::vector<double> turns(span.clamps.size(), 0);
  for (std::size_t k = 1; k < turns.size(); ++k) {
    const Eigen::Index node = node_at(mesh.s, span.clamps[k].at);
    const auto interval = static_cast<std::size_t>(std::min(node, mesh.intervals() - 1));
    const Eigen::Quaterniond turn = clamp_frame(span, k, 0).conjugate() * frames[interval];
    turns[k] = 2 * std::atan2(turn.z(), turn.w());
  }
  return turns;
}

}  // namespace dlo::energy_model
