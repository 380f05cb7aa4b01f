#include "kirchhoff/rod_mesh.hpp"

#include <algorithm>
#include <cmath>

namespace dlo::energy_model {

Eigen::Index node_at(const Eigen::VectorXd& nodes, double s) {
  return std::lower_bound(nodes.begin(), nodes.end(), s) - nodes.begin();
}

RodMesh make_mesh(const RodSpan& span, double longest, const std::vector<double>& further) {
  std::vector<double> fixed = further;
  fixed.insert(fixed.end(), {0, span.length});
  for (const RodSpan::Hold& hold : span.holds) fixed.push_back(hold.at);
  for (const RodSpan::Load& load : span.loads) fixed.push_back(load.at);
  for (const RodSpan::Part& part : span.parts) fixed.push_back(part.begin);
  std::sort(fixed.begin(), fixed.end());
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  std::vector<double> nodes = {0};
  for (std::size_t i = 0; i + 1 < fixed.size(); ++i) {
    const double width = fixed[i + 1] - fixed[i];
    // A rod with slack between two grips has to bend, which one interval could not.
    const auto next = std::ranges::upper_bound(span.holds, fixed[i], {}, &RodSpan::Hold::at);
    double own = longest;
    if (next != span.holds.begin() && next != span.holds.end()) {
      own = std::min(own, (next->at - (next - 1)->at) / 8);
    }
    const int parts = static_cast<int>(std::ceil(width / own));
    for (int k = 1; k < parts; ++k) nodes.push_back(fixed[i] + width * k / parts);
    nodes.push_back(fixed[i + 1]);
  }
  return mesh_at(span, Eigen::Map<const Eigen::VectorXd>(nodes.data(),
                                                         static_cast<Eigen::Index>(nodes.size())));
}

RodMesh mesh_at(const RodSpan& span, const Eigen::VectorXd& nodes) {
  RodMesh mesh;
  mesh.s = nodes;
  mesh.load = Eigen::Matrix3Xd::Zero(3, nodes.size());
  mesh.tangent_force = mesh.load;
  mesh.d1_force = mesh.load;
  mesh.hold.assign(static_cast<std::size_t>(nodes.size()), nullptr);
  mesh.couple = mesh.load;
  mesh.follower_load = mesh.load;
  mesh.follower_couple = mesh.load;
  for (const RodSpan::Load& load : span.loads) {
    const Eigen::Index node = node_at(nodes, load.at);
    (load.follows ? mesh.follower_load : mesh.load).col(node) += load.force;
    (load.follows ? mesh.follower_couple : mesh.couple).col(node) += load.couple;
  }
  for (const RodSpan::Hold& hold : span.holds) {
    mesh.hold[static_cast<std::size_t>(node_at(nodes, hold.at))] = &hold;
  }
  for (Eigen::Index i = 0; i < mesh.intervals(); ++i) {
    mesh.section.push_back(&section_at(span, (nodes[i] + nodes[i + 1]) / 2));
  }
  return mesh;
}

ForceField internal_force(const RodSpan& span, const RodMesh& mesh) {
  const Eigen::Index last = mesh.intervals();
  ForceField field;
  field.on_interval.resize(3, last);
  field.after_node.resize(3, last + 1);
  // The first grip carries the sum of all loads.
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  Eigen::Vector3d all = mesh.load.rowwise().sum();
  for (const RodSpan::Part& part : span.parts) {
    all += part.section.weight_of_interval(part.begin, part.end - part.begin);
  }
  for (Eigen::Index i = 0; i <= last; ++i) {
    n -= mesh.load.col(i);
    if (mesh.hold[static_cast<std::size_t>(i)] == &span.holds.front()) n += all;
    field.after_node.col(i) = n;
    if (i == last) break;
    const RodSection& section = mesh.section_of(i);
    field.on_interval.col(i) = n - section.weight_of_interval(mesh.s[i], mesh.width(i) / 2);
    n -= section.weight_of_interval(mesh.s[i], mesh.width(i));
  }
  return field;
}

}  // namespace dlo::energy_model
