#include "rod_span.hpp"

#include <algorithm>
#include <cmath>

#include "ordered_grips.hpp"
#include "require.hpp"

namespace dlo::energy_model {
namespace {

constexpr double same_place = 1e-9;  // in l

/// In units of l; what is nearly at an end of the rod is there.
double own_arc_length(double at, double length) {
  const double s = at / length;
  if (s < same_place) return 0;
  return s > 1 - same_place ? 1 : s;
}

std::optional<Plane> plane_of(const RodSpan& span) {
  std::vector<Eigen::Vector3d> directions;
  if (span.start_direction) directions.push_back(*span.start_direction);
  if (span.end_direction) directions.push_back(*span.end_direction);
  for (const RodSpan::Hold& hold : span.holds) {
    const Eigen::Vector3d chord = hold.position - span.holds.front().position;
    if (chord.norm() > same_place) directions.emplace_back(chord.normalized());
  }
  const double largest = total_load(span);
  if (largest > 0) {
    directions.emplace_back(span.weight / largest);
    for (const RodSpan::Load& load : span.loads) directions.emplace_back(load.force / largest);
  }
  if (directions.empty()) directions.emplace_back(Eigen::Vector3d::UnitX());
  // A pinned rod without a direction of its own starts with its weight, which may be zero.
  const auto first = std::max_element(
      directions.begin(), directions.end(),
      [](const auto& a, const auto& b) { return a.norm() < b.norm() * (1 - same_place); });
  if (first->norm() == 0) *first = Eigen::Vector3d::UnitX();
  return find_plane(span.holds.front().position, *first, directions);
}

/// What the clamps at the ends of a span hold; nothing unless both hold the rod's frame.
std::optional<RodSpan::Twist> twist_between(const Problem& problem, const Grip* start,
                                            const Grip* end) {
  if (start == nullptr || end == nullptr || !start->frame || !end->frame) return std::nullopt;
  RodSpan::Twist twist;
  twist.stiffness = problem.torsional_stiffness / problem.bending_stiffness;
  twist.roll = end->frame->roll - start->frame->roll;
  if (!start->frame->d1 || !end->frame->d1) return twist;
  const auto across = [](const Grip& grip) {
    const Eigen::Vector3d t = grip.direction->normalized();
    return Eigen::Vector3d((*grip.frame->d1 - grip.frame->d1->dot(t) * t).normalized());
  };
  twist.start_d1 = across(*start);
  twist.end_d1 = across(*end);
  return twist;
}

RodSpan make_span(const Problem& problem, const std::vector<OrderedGrip>& grips, double begin,
                  double end) {
  const double l = problem.length;
  const double force_unit = problem.bending_stiffness / (l * l);
  const Eigen::Vector3d origin = problem.grips.front().position;
  RodSpan span;
  span.begin = begin;
  span.length = end - begin;
  span.weight = problem.weight_per_length * l / force_unit;
  const Grip* start_clamp = nullptr;
  const Grip* end_clamp = nullptr;
  for (const OrderedGrip& grip : grips) {
    const double at = own_arc_length(grip.grip->at, l);
    if (at < begin || at > end) continue;
    span.holds.push_back({at - begin, (grip.grip->position - origin) / l, grip.index});
    if (!grip.grip->direction) continue;
    (at == begin ? span.start_direction : span.end_direction) = grip.grip->direction->normalized();
    (at == begin ? start_clamp : end_clamp) = grip.grip;
  }
  for (const Load& load : problem.loads) {
    const double at = own_arc_length(load.at, l);
    if (at < begin || at > end || clamp_under(problem, load)) continue;
    span.loads.push_back({at - begin, load.force / force_unit});
  }
  std::stable_sort(span.loads.begin(), span.loads.end(),
                   [](const auto& a, const auto& b) { return a.at < b.at; });
  span.plane = plane_of(span);
  span.twist = twist_between(problem, start_clamp, end_clamp);
  return span;
}

}  // namespace

std::vector<RodSpan> cut_at_clamps(const Problem& problem) {
  check(problem);
  require(problem.walls.empty(), "solve_exact", "number of walls",
          static_cast<double>(problem.walls.size()), "0");
  const std::vector<OrderedGrip> grips = ordered_grips(problem);
  std::vector<double> cuts = {0, 1};
  for (const OrderedGrip& grip : grips) {
    if (grip.grip->direction) cuts.push_back(own_arc_length(grip.grip->at, problem.length));
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<RodSpan> spans;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    spans.push_back(make_span(problem, grips, cuts[i], cuts[i + 1]));
  }
  return spans;
}

RodMesh make_mesh(const RodSpan& span, double longest) {
  std::vector<double> fixed = {0, span.length};
  for (const RodSpan::Hold& hold : span.holds) fixed.push_back(hold.at);
  for (const RodSpan::Load& load : span.loads) fixed.push_back(load.at);
  std::sort(fixed.begin(), fixed.end());
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  std::vector<double> nodes = {0};
  for (std::size_t i = 0; i + 1 < fixed.size(); ++i) {
    const double width = fixed[i + 1] - fixed[i];
    // Rod to spare between two grips has to bend: one interval could not.
    constexpr int least_parts = 8;
    const auto next =
        std::upper_bound(span.holds.begin(), span.holds.end(), fixed[i],
                         [](double at, const RodSpan::Hold& hold) { return at < hold.at; });
    double own = longest;
    if (next != span.holds.begin() && next != span.holds.end()) {
      own = std::min(own, (next->at - (next - 1)->at) / least_parts);
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
  mesh.pull = mesh.load;
  mesh.hold.assign(static_cast<std::size_t>(nodes.size()), nullptr);
  const auto node_at = [&](double s) {
    return std::lower_bound(nodes.begin(), nodes.end(), s) - nodes.begin();
  };
  for (const RodSpan::Load& load : span.loads) mesh.load.col(node_at(load.at)) += load.force;
  for (const RodSpan::Hold& hold : span.holds) {
    mesh.hold[static_cast<std::size_t>(node_at(hold.at))] = &hold;
  }
  return mesh;
}

ForceField carried_force(const RodSpan& span, const RodMesh& mesh) {
  const Eigen::Index last = mesh.intervals();
  ForceField field;
  field.on_interval.resize(3, last);
  field.after_node.resize(3, last + 1);
  // The first grip carries what nothing else does.
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  const Eigen::Vector3d all = span.length * span.weight + mesh.load.rowwise().sum();
  for (Eigen::Index i = 0; i <= last; ++i) {
    n -= mesh.load.col(i);
    if (mesh.hold[static_cast<std::size_t>(i)] == &span.holds.front()) n += all;
    field.after_node.col(i) = n;
    if (i == last) break;
    const double h = mesh.s[i + 1] - mesh.s[i];
    field.on_interval.col(i) = n - h / 2 * span.weight;
    n -= h * span.weight;
  }
  return field;
}

double total_load(const RodSpan& span) {
  double load = span.length * span.weight.norm();
  for (const RodSpan::Load& l : span.loads) load += l.force.norm();
  return load;
}

}  // namespace dlo::energy_model
