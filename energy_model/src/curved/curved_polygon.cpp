#include "curved/curved_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/minimise.hpp"

namespace dlo::energy_model {
namespace {

using Eigen::Quaterniond;
using std::numbers::pi;

constexpr int augmented_rounds = 12;
constexpr int round_evaluations = 400;
constexpr int remembered = 15;            // steps of L-BFGS: an evaluation is cheap
constexpr double polygon_at_rest = 1e-5;  // gradient over 1 + load
constexpr double closed_gap = 1e-4;       // at a grip

/// A place where two frames meet.
struct FrameJoint {
  Eigen::Index left, right;   // frames: of intervals, then of clamps
  Eigen::Index node;          // of the mesh
  double h;                   // of the rod between
  Eigen::Vector3d stiffness;  // of the rod between
  Eigen::Vector3d natural;
};

Quaterniond turned_about_t(const Quaterniond& frame, double angle) {
  return frame * Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

/// The frame of a clamp at which the turn of one that it does not hold is zero.
Quaterniond clamp_frame(const CurvedRod& rod, const ClampFrames& held, std::size_t k) {
  if (held[k]) return Quaterniond(*held[k]);
  return Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), rod.span.clamps[k].direction);
}

Eigen::Index node_of(const RodMesh& mesh, double s) {
  return std::lower_bound(mesh.s.begin(), mesh.s.end(), s) - mesh.s.begin();
}

std::vector<FrameJoint> joints_of(const CurvedRod& rod, const RodMesh& mesh) {
  std::vector<FrameJoint> joints;
  const auto stiffness = [&](Eigen::Index i) { return mesh.section_of(i).stiffness(); };
  const auto to_clamp = [&](Eigen::Index i, Eigen::Index clamp, bool before) {
    const double h = mesh.width(i) / 2;
    const double middle = before ? mesh.s[i + 1] - h / 2 : mesh.s[i] + h / 2;
    joints.push_back({before ? i : clamp, before ? clamp : i, before ? i + 1 : i, h, stiffness(i),
                      rod.span.natural(middle)});
  };
  for (Eigen::Index i = 0; i <= mesh.intervals(); ++i) {
    const RodSpan::Clamp* clamp = rod.span.clamp_at(mesh.s[i]);
    if (clamp != nullptr) {
      const Eigen::Index frame = mesh.intervals() + (clamp - rod.span.clamps.data());
      if (i > 0) to_clamp(i - 1, frame, true);
      if (i < mesh.intervals()) to_clamp(i, frame, false);
    } else if (i > 0 && i < mesh.intervals()) {
      const double before = mesh.width(i - 1) / 2;
      const double after = mesh.width(i) / 2;
      const Eigen::Vector3d compliance =
          before * stiffness(i - 1).cwiseInverse() + after * stiffness(i).cwiseInverse();
      joints.push_back({i - 1, i, i, before + after, (before + after) * compliance.cwiseInverse(),
                        rod.span.natural(mesh.s[i] + (after - before) / 2)});
    }
  }
  return joints;
}

/// The intervals between two neighbouring grips.
struct GripGap {
  Eigen::Index first, end;
  Eigen::Vector3d chord;
  double penalty;
  Eigen::Vector3d multiplier = Eigen::Vector3d::Zero();
};

/// The polygon's energy, of the quaternions of the intervals and the turns at clamps.
class CurvedPolygonEnergy {
 public:
  CurvedPolygonEnergy(const CurvedRod& rod, const RodMesh& mesh, const ClampFrames& held)
      : mesh_(mesh),
        held_(held),
        joints_(joints_of(rod, mesh)),
        carried_(carried_force(rod.span, mesh).on_interval) {
    Eigen::Index first = -1;
    for (Eigen::Index i = 0; i <= mesh.intervals(); ++i) {
      const RodSpan::Hold* hold = mesh.hold[static_cast<std::size_t>(i)];
      if (hold == nullptr) continue;
      if (first >= 0) {
        const double length = mesh.s[i] - mesh.s[first];
        const Eigen::Vector3d before = mesh.hold[static_cast<std::size_t>(first)]->position;
        const double penalty =
            (100 * softest(rod.span) / (length * length) + 4 * total_load(rod.span)) / length;
        gaps.push_back({first, i, hold->position - before, penalty});
      }
      first = i;
    }
    for (std::size_t k = 0; k < held.size(); ++k) {
      clamp_frames_.push_back(clamp_frame(rod, held, k));
    }
  }

  [[nodiscard]] Eigen::Index size() const {
    return 4 * mesh_.intervals() + static_cast<Eigen::Index>(held_.size());
  }

  [[nodiscard]] Quaterniond frame(const Eigen::Ref<const Eigen::VectorXd>& x,
                                  Eigen::Index i) const {
    if (i < mesh_.intervals()) {
      return Quaterniond(x[4 * i], x[4 * i + 1], x[4 * i + 2], x[4 * i + 3]).normalized();
    }
    const auto clamp = static_cast<std::size_t>(i - mesh_.intervals());
    if (held_[clamp]) return clamp_frames_[clamp];
    return turned_about_t(clamp_frames_[clamp], x[3 * mesh_.intervals() + i]);
  }

  [[nodiscard]] Eigen::Vector3d gap(const Eigen::Ref<const Eigen::VectorXd>& x,
                                    const GripGap& of) const {
    Eigen::Vector3d gap = -of.chord;
    for (Eigen::Index i = of.first; i < of.end; ++i) {
      gap += mesh_.width(i) * (frame(x, i) * Eigen::Vector3d::UnitZ());
    }
    return gap;
  }

  /// n_i with the multipliers'.
  [[nodiscard]] Eigen::Matrix3Xd force(const Eigen::Ref<const Eigen::VectorXd>& x) const {
    Eigen::Matrix3Xd force = carried_;
    for (const GripGap& of : gaps) {
      force.middleCols(of.first, of.end - of.first).colwise() -=
          of.multiplier + of.penalty * gap(x, of);
    }
    return force;
  }

  double operator()(const Eigen::Ref<const Eigen::VectorXd>& x,
                    Eigen::Ref<Eigen::VectorXd> gradient) const {
    const Eigen::Index count = mesh_.intervals();
    std::vector<Quaterniond> q;
    for (Eigen::Index i = 0; i < count + static_cast<Eigen::Index>(held_.size()); ++i) {
      q.push_back(frame(x, i));
    }
    Eigen::Matrix4Xd by_frame = Eigen::Matrix4Xd::Zero(4, static_cast<Eigen::Index>(q.size()));
    const auto add = [&](Eigen::Index i, const Quaterniond& p) {
      by_frame.col(i) += Eigen::Vector4d(p.w(), p.x(), p.y(), p.z());
    };
    double energy = 0;
    for (const FrameJoint& joint : joints_) {
      const Quaterniond& a = q[static_cast<std::size_t>(joint.left)];
      const Quaterniond& b = q[static_cast<std::size_t>(joint.right)];
      const Quaterniond turn = a.conjugate() * b;
      const double factor = (turn.w() < 0 ? -2 : 2) / joint.h;
      const Eigen::Vector3d excess = factor * turn.vec() - joint.natural;
      const Eigen::Vector3d moment = joint.stiffness.cwiseProduct(excess);
      energy += joint.h / 2 * excess.dot(moment);
      const Eigen::Vector3d by_turn = joint.h * factor * moment;
      const Quaterniond pure(0, by_turn.x(), by_turn.y(), by_turn.z());
      add(joint.right, a * pure);
      const Quaterniond left = b * pure;
      add(joint.left, Quaterniond(-left.w(), -left.x(), -left.y(), -left.z()));
    }
    const Eigen::Matrix3Xd n = force(x);
    for (const GripGap& of : gaps) {
      const Eigen::Vector3d open = gap(x, of);
      energy += of.multiplier.dot(open) + of.penalty / 2 * open.squaredNorm();
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const Quaterniond& p = q[static_cast<std::size_t>(i)];
      energy -= mesh_.width(i) * carried_.col(i).dot(p * Eigen::Vector3d::UnitZ());
      const Eigen::Vector3d f = -2 * mesh_.width(i) * n.col(i);
      by_frame.col(i) += Eigen::Vector4d(
          f[0] * p.y() - f[1] * p.x(), f[0] * p.z() - f[1] * p.w() - 2 * f[2] * p.x(),
          f[0] * p.w() + f[1] * p.z() - 2 * f[2] * p.y(), f[0] * p.x() + f[1] * p.y());
    }
    gradient.setZero();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Vector4d own = x.segment<4>(4 * i);
      const double norm = own.norm();
      const Eigen::Vector4d unit = own / norm;
      const Eigen::Vector4d slope = by_frame.col(i);
      gradient.segment<4>(4 * i) = (slope - unit * unit.dot(slope)) / norm;
    }
    for (std::size_t k = 0; k < held_.size(); ++k) {
      if (held_[k]) continue;
      const auto at = static_cast<Eigen::Index>(k);
      const Quaterniond& p = q[static_cast<std::size_t>(count) + k];
      const Quaterniond rate = p * Quaterniond(0, 0, 0, 0.5);
      gradient[4 * count + at] =
          by_frame.col(count + at).dot(Eigen::Vector4d(rate.w(), rate.x(), rate.y(), rate.z()));
    }
    return energy;
  }

  std::vector<GripGap> gaps;

 private:
  const RodMesh& mesh_;
  const ClampFrames& held_;
  std::vector<FrameJoint> joints_;
  std::vector<Quaterniond> clamp_frames_;
  Eigen::Matrix3Xd carried_;
};

/// The rod as it is by nature, from a frame at a node on.
std::vector<Quaterniond> natural_shape(const CurvedRod& rod, const RodMesh& mesh, Eigen::Index node,
                                       const Quaterniond& frame) {
  std::vector<Quaterniond> shape(static_cast<std::size_t>(mesh.intervals()));
  const auto half = [&](Eigen::Index i, double side) {
    const Eigen::Vector3d turn =
        side * mesh.width(i) / 2 * rod.span.natural((mesh.s[i] + mesh.s[i + 1]) / 2);
    return Quaterniond(rotation_by(turn));
  };
  Quaterniond at = frame;
  for (Eigen::Index i = node; i < mesh.intervals(); ++i) {
    shape[static_cast<std::size_t>(i)] = at * half(i, 1);
    at = shape[static_cast<std::size_t>(i)] * half(i, 1);
  }
  at = frame;
  for (Eigen::Index i = node; i-- > 0;) {
    shape[static_cast<std::size_t>(i)] = at * half(i, -1);
    at = shape[static_cast<std::size_t>(i)] * half(i, -1);
  }
  return shape;
}

}  // namespace

CurvedPolygon relax_curved(const CurvedRod& rod, const RodMesh& mesh, const ClampFrames& held,
                           const std::vector<Quaterniond>& start, const Deadline& deadline) {
  CurvedPolygonEnergy energy(rod, mesh, held);
  const Eigen::Index count = mesh.intervals();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(energy.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Quaterniond& q = start[static_cast<std::size_t>(i)];
    x.segment<4>(4 * i) << q.w(), q.x(), q.y(), q.z();
  }
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (held[k]) continue;
    // Turned as the rod beside it is.
    const Eigen::Index node = node_of(mesh, rod.span.clamps[k].at);
    const Quaterniond beside = energy.frame(x, std::min(node, count - 1));
    const Quaterniond turn = clamp_frame(rod, held, k).conjugate() * beside;
    x[4 * count + static_cast<Eigen::Index>(k)] = 2 * std::atan2(turn.z(), turn.w());
  }
  const double unit = 1 + total_load(rod.span);
  const int rounds = energy.gaps.empty() ? 2 : augmented_rounds;
  for (int round = 0; round < rounds && !deadline.passed(); ++round) {
    const MinimiseResult rest = minimise_lbfgs(std::cref(energy), x,
                                               {.gradient_tolerance = polygon_at_rest * unit,
                                                .max_evaluations = round_evaluations,
                                                .remembered_steps = remembered,
                                                .deadline = deadline});
    double widest = 0;
    for (GripGap& gap : energy.gaps) {
      const Eigen::Vector3d open = energy.gap(x, gap);
      gap.multiplier += gap.penalty * open;
      widest = std::max(widest, open.norm());
    }
    for (Eigen::Index i = 0; i < count; ++i) x.segment<4>(4 * i).normalize();
    if (widest < closed_gap && succeeded(rest.status)) break;
  }
  CurvedPolygon polygon;
  Eigen::VectorXd gradient(x.size());
  polygon.energy = energy(x, gradient);
  polygon.force = energy.force(x);
  for (Eigen::Index i = 0; i < count; ++i) polygon.frames.push_back(energy.frame(x, i));
  const Eigen::VectorXd turns = x.tail(static_cast<Eigen::Index>(held.size()));
  polygon.turns.assign(turns.begin(), turns.end());
  return polygon;
}

std::vector<std::vector<Quaterniond>> curved_starts(const CurvedRod& rod, const RodMesh& mesh,
                                                    bool planar) {
  const Eigen::Index count = mesh.intervals();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const RodSpan::Hold& first = rod.span.holds.front();
  const RodSpan::Hold& last = rod.span.holds.back();
  Eigen::Vector3d line = z;
  double share = 0.7;
  if (last.at > first.at) {
    const Eigen::Vector3d chord = last.position - first.position;
    share = chord.norm() / (last.at - first.at);
    if (share > 1e-6) line = chord.normalized();
  }
  const Quaterniond along = Quaterniond::FromTwoVectors(z, line);
  const double clamp_place = rod.span.clamps.empty() ? 0 : rod.span.clamps.front().at;
  const Eigen::Index clamp_node = node_of(mesh, clamp_place);
  std::vector<std::vector<Quaterniond>> starts;
  starts.push_back(natural_shape(rod, mesh, clamp_node,
                                 rod.span.clamps.empty() ? along : Quaterniond::Identity()));
  starts.emplace_back(static_cast<std::size_t>(count), along);
  const Eigen::Matrix3Xd carried = carried_force(rod.span, mesh).on_interval;
  for (const double side : {1.0, -1.0}) {
    std::vector<Quaterniond> hanging(static_cast<std::size_t>(count), along);
    for (Eigen::Index i = 0; i < count; ++i) {
      if (carried.col(i).norm() == 0) continue;
      const Eigen::Vector3d t = side * carried.col(i).normalized();
      // Half a turn has no least one: it stays in the plane.
      hanging[static_cast<std::size_t>(i)] =
          t.z() < -1 + 1e-9 ? Quaterniond(0, 0, 1, 0) : Quaterniond::FromTwoVectors(z, t);
    }
    starts.push_back(std::move(hanging));
  }
  const double amplitude = 2 * std::sqrt(std::max(0.0, 1 - share));
  const std::vector<std::function<double(double)>> angles = {
      [&](double x) { return amplitude * std::cos(pi * x); },
      [&](double x) { return amplitude * std::sin(2 * pi * x); },
      [&](double x) { return amplitude * std::cos(2 * pi * x); },
      [&](double x) { return 2 * pi * x; }};
  std::vector<Eigen::Vector3d> normals = {Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitY()};
  if (!planar) {
    normals.clear();
    constexpr int around = 4;
    for (int i = 0; i < around; ++i) {
      // Not through the plane itself, where the planar search has been.
      const double angle = 2 * pi * (i + 0.1) / around;
      normals.emplace_back(along * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0));
    }
  }
  for (const auto& angle : angles) {
    for (const Eigen::Vector3d& normal : normals) {
      std::vector<Quaterniond> start;
      for (Eigen::Index i = 0; i < count; ++i) {
        const double a = angle((mesh.s[i] + mesh.s[i + 1]) / 2);
        start.emplace_back(Quaterniond(rotation_by(a * normal)) * along);
      }
      starts.push_back(std::move(start));
    }
  }
  if (planar) return starts;
  // Out of the plane, where the shapes that lie in it may be unstable.
  constexpr std::size_t of_the_plane = 4;
  constexpr double out = 0.2;
  for (std::size_t k = 0; k < of_the_plane; ++k) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const double s = (mesh.s[i] + mesh.s[i + 1]) / 2 - clamp_place;
      const Quaterniond tilt(rotation_by(out * std::sin(2 * s) * Eigen::Vector3d(1, 0, 1)));
      Quaterniond& q = starts[k][static_cast<std::size_t>(i)];
      q = tilt * q;
    }
  }
  return starts;
}

std::vector<RodState> curved_states_of(const CurvedRod& rod, const RodMesh& mesh,
                                       const ClampFrames& held, const CurvedPolygon& polygon) {
  const Eigen::Index last = mesh.intervals();
  const ForceField carried = carried_force(rod.span, mesh);
  std::vector<RodState> states(static_cast<std::size_t>(last + 1));
  std::vector<Quaterniond> q = polygon.frames;
  for (std::size_t k = 0; k < held.size(); ++k) {
    q.push_back(held[k] ? Quaterniond(*held[k])
                        : turned_about_t(clamp_frame(rod, held, k), polygon.turns[k]));
  }
  // The moment after a node is that of the joint there, of two the later one.
  for (const FrameJoint& joint : joints_of(rod, mesh)) {
    const Quaterniond& a = q[static_cast<std::size_t>(joint.left)];
    const Quaterniond turn = a.conjugate() * q[static_cast<std::size_t>(joint.right)];
    const double factor = (turn.w() < 0 ? -2 : 2) / joint.h;
    states[static_cast<std::size_t>(joint.node)].m =
        a * Eigen::Vector3d(joint.stiffness.cwiseProduct(factor * turn.vec() - joint.natural));
  }
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i <= last; ++i) {
    RodState& state = states[static_cast<std::size_t>(i)];
    const auto before = static_cast<std::size_t>(std::max<Eigen::Index>(i - 1, 0));
    const auto after = static_cast<std::size_t>(std::min(i, last - 1));
    state.R = q[before].slerp(0.5, q[after]).toRotationMatrix();
    if (const RodSpan::Clamp* clamp = rod.span.clamp_at(mesh.s[i])) {
      state.R =
          q[static_cast<std::size_t>(last + (clamp - rod.span.clamps.data()))].toRotationMatrix();
    }
    state.r = r;
    if (mesh.hold[static_cast<std::size_t>(i)] == &rod.span.holds.front()) {
      shift = rod.span.holds.front().position - r;
    }
    if (i == last) {
      state.m.setZero();
      break;
    }
    // What the grips add is constant between them.
    state.n = carried.after_node.col(i) + polygon.force.col(i) - carried.on_interval.col(i);
    r += mesh.width(i) * (polygon.frames[static_cast<std::size_t>(i)] * Eigen::Vector3d::UnitZ());
  }
  for (RodState& state : states) state.r += shift;
  return states;
}

}  // namespace dlo::energy_model
