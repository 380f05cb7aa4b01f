#include "dlo/force_model/rod.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "dlo/force_model/contraction.hpp"
#include "point_masses.hpp"
#include "require.hpp"
#include "twisted_spans.hpp"

namespace dlo::force_model {
namespace {

using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

void check_grip(const Grip& grip, Eigen::Index points) {
  const auto point_count = static_cast<double>(grip.targets.cols());
  require(point_count == 1 || point_count == 2, "Rod", "points held by a grip", point_count,
          "1 or 2");
  require(grip.first_point >= 0 && grip.first_point + grip.targets.cols() <= points, "Rod",
          "first point of a grip", static_cast<double>(grip.first_point),
          ">= 0, with all points of the grip on the rod");
  require(grip.targets.allFinite(), "Rod", "targets of a grip", grip.targets.norm(), "finite");
  if (grip.hold == GripHold::spring) require_positive("Rod", "grip stiffness", grip.stiffness);
  if (!grip.d1) return;
  require(point_count == 2 && grip.hold == GripHold::rigid, "Rod", "points held by a grip with d1",
          point_count, "2 with a rigid hold: one point, or a segment on springs, holds no frame");
  require(grip.d1->allFinite(), "Rod", "|d1| of a grip", grip.d1->norm(), "finite");
  // Below this fraction of its length, the direction of the transverse component is determined by
  // rounding.
  constexpr double least_across = 1e-6;
  const Eigen::Vector3d along = (grip.targets.col(1) - grip.targets.col(0)).normalized();
  const double across = along.cross(*grip.d1).norm();
  require(across > least_across * grip.d1->norm(), "Rod", "part of d1 across its segment", across,
          "> 0");
}

void check_twist(const Rod& rod) {
  const Twist& twist = rod.twist;
  require_not_negative("Rod", "torsional stiffness", twist.stiffness);
  const auto joints = twist.stiffnesses.size();
  require(joints == 0 || joints == rod.rest_lengths.size() - 1, "Rod",
          "size of torsional stiffnesses", static_cast<double>(joints),
          "0 or the number of joints");
  Eigen::Index spans = 0;
  for_each_twisted_span(
      rod, [&](const TwistedSpan& span, const Grip& /*first*/, const Grip& /*last*/) {
        ++spans;
        for (Eigen::Index i = span.first_segment + 1; i <= span.last_segment; ++i) {
          require_positive("Rod", "torsional stiffness of a joint between two grips with d1",
                           joints > 0 ? twist.stiffnesses[i - 1] : twist.stiffness);
          require_positive("Rod", "bending stiffness of a joint between two grips with d1",
                           bending_at(rod.bending, i).stiffness);
        }
      });
  const auto angles = twist.angles.size();
  require(angles == 0 || angles == spans, "Rod", "size of twist angles",
          static_cast<double>(angles), "0 or the number of parts between grips with d1");
  require(twist.angles.allFinite(), "Rod", "twist angles", twist.angles.norm(), "finite");
  if (spans == 0) return;
  const auto framed = static_cast<double>(spans + 1);
  require(rod.bending.law == BendingLaw::hooke, "Rod", "number of grips with d1", framed,
          "0 or 1 with the paper's bending law, which has no twist");
  require(rod.bending.natural_turns.size() == 0, "Rod", "number of grips with d1", framed,
          "0 or 1 for a rod with natural turns, which stays in a plane");
}

/// Checks that no two rigid grips hold the same point, since each exerts all forces on its points.
void require_own_points(std::string_view function, const std::vector<Grip>& grips) {
  for (std::size_t i = 0; i < grips.size(); ++i) {
    if (grips[i].hold == GripHold::spring) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if (grips[j].hold == GripHold::spring) continue;
      const Eigen::Index begin = std::max(grips[i].first_point, grips[j].first_point);
      const Eigen::Index end = std::min(grips[i].first_point + grips[i].targets.cols(),
                                        grips[j].first_point + grips[j].targets.cols());
      require(begin >= end, function, "point held by two rigid grips", static_cast<double>(begin),
              "held by only one of them");
    }
  }
}

Eigen::Vector3d grip_force_on_point(const Grip& grip, Eigen::Index k, const Points& points,
                                    const Points& forces) {
  const Eigen::Index i = grip.first_point + k;
  if (grip.hold == GripHold::rigid) return -forces.col(i);
  return spring_force(grip.stiffness, grip.targets.col(k), points.col(i));
}

}  // namespace

const Grip* next_framed_grip(const Rod& rod, const Grip* after) {
  const Grip* next = nullptr;
  for (const Grip& grip : rod.grips) {
    if (!grip.d1 || (after != nullptr && grip.first_point <= after->first_point)) continue;
    if (next == nullptr || grip.first_point < next->first_point) next = &grip;
  }
  return next;
}

TwistedSpan make_twisted_span(const Rod& rod, const Grip& first, const Grip& last,
                              Eigen::Index number) {
  TwistedSpan span;
  span.first_segment = first.first_point;
  span.last_segment = last.first_point;
  span.first_d1 = *first.d1;
  span.last_d1 = *last.d1;
  const Twist& twist = rod.twist;
  for (Eigen::Index i = span.first_segment + 1; i <= span.last_segment; ++i) {
    const double length = (rod.rest_lengths[i - 1] + rod.rest_lengths[i]) / 2;
    span.compliance +=
        length / (twist.stiffnesses.size() > 0 ? twist.stiffnesses[i - 1] : twist.stiffness);
  }
  if (number < twist.angles.size()) span.angle = twist.angles[number];
  return span;
}

std::vector<TwistedSpan> twisted_spans(const Rod& rod) {
  check(rod);
  std::vector<TwistedSpan> spans;
  for_each_twisted_span(rod, [&spans](const TwistedSpan& span, const Grip& /*first*/,
                                      const Grip& /*last*/) { spans.push_back(span); });
  return spans;
}

bool is_planar(const Rod& rod) {
  if (std::count_if(rod.grips.begin(), rod.grips.end(),
                    [](const Grip& grip) { return grip.d1.has_value(); }) > 1) {
    return false;
  }
  const auto in_plane = [](const Grip& grip) { return (grip.targets.row(2).array() == 0).all(); };
  const auto upright = [](const Wall& wall) { return wall.normal.z() == 0; };
  const auto symmetric = [&rod](const Solid& solid) {
    return solid.body.is_symmetric(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), rod.length());
  };
  return (rod.loads.row(2).array() == 0).all() &&
         std::all_of(rod.solids.begin(), rod.solids.end(), symmetric) &&
         std::all_of(rod.grips.begin(), rod.grips.end(), in_plane) &&
         std::all_of(rod.walls.begin(), rod.walls.end(), upright);
}

void check(const Rod& rod) {
  const auto segments = static_cast<double>(rod.rest_lengths.size());
  require(segments >= 1, "Rod", "number of segments", segments, ">= 1");
  const double shortest = rod.rest_lengths.minCoeff();
  require(shortest > 0 && rod.rest_lengths.allFinite(), "Rod", "smallest rest length", shortest,
          "finite and > 0");
  require_not_negative("Rod", "c_c", rod.c_c);
  check(rod.bending, rod.rest_lengths.size());
  require(rod.loads.cols() == rod.points(), "Rod", "columns of loads",
          static_cast<double>(rod.loads.cols()), "the number of points");
  require(rod.loads.allFinite(), "Rod", "loads", rod.loads.norm(), "finite");
  require(rod.masses.size() == 0 || rod.masses.size() == rod.points(), "Rod", "number of masses",
          static_cast<double>(rod.masses.size()), "0 or the number of points");
  for (const double mass : rod.masses) require_not_negative("Rod", "mass of a point", mass);
  for (const Wall& wall : rod.walls) check(wall);
  for (const Solid& solid : rod.solids) check(solid);
  for (const Grip& grip : rod.grips) check_grip(grip, rod.points());
  require_own_points("Rod", rod.grips);
  check_twist(rod);
  if (rod.bending.natural_turns.size() > 0) {
    require(is_planar(rod), "Rod", "number of natural turns",
            static_cast<double>(rod.bending.natural_turns.size()),
            "0 unless loads, grips, walls and solids lie in the plane z = 0");
  }
}

void total_forces(const Rod& rod, const Points& points, Eigen::Ref<Eigen::Matrix3Xd> forces) {
  require(forces.cols() == rod.loads.cols(), "total_forces", "columns of forces",
          static_cast<double>(forces.cols()), "the number of points");
  forces = rod.loads;  // (6)
  add_contraction_forces(points, rod.rest_lengths, rod.c_c, forces);
  add_bending_forces(points, rod.rest_lengths, rod.bending, forces);
  for_each_twisted_span(rod, [&](const TwistedSpan& span, const Grip& /*first*/,
                                 const Grip& /*last*/) { add_twist_forces(span, points, forces); });
  for (const Wall& wall : rod.walls) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      forces.col(i) += wall_force(wall, points.col(i));
    }
  }
  for (const Solid& solid : rod.solids) add_solid_forces(solid, points, forces);
  for_each_grip_point(rod, GripHold::spring, [&](const Grip& grip, Eigen::Index k) {
    const Eigen::Index i = grip.first_point + k;
    forces.col(i) += spring_force(grip.stiffness, grip.targets.col(k), points.col(i));
  });
}

void grip_reactions(const Rod& rod, const Points& points, Eigen::Ref<Eigen::Matrix3Xd> forces,
                    std::span<GripReaction> reactions) {
  require(reactions.size() == rod.grips.size(), "grip_reactions", "number of reactions",
          static_cast<double>(reactions.size()), "the number of grips");
  require_own_points("grip_reactions", rod.grips);
  total_forces(rod, points, forces);
  for (std::size_t g = 0; g < rod.grips.size(); ++g) {
    const Grip& grip = rod.grips[g];
    GripReaction reaction;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      const Eigen::Vector3d force = grip_force_on_point(grip, k, points, forces);
      const Eigen::Vector3d arm = points.col(grip.first_point + k) - grip.reference;
      reaction.force += force;
      reaction.torque += arm.cross(force);
    }
    reactions[g] = reaction;
  }
  // A grip that holds the frame carries the twisting moment about its segment.
  const auto direction = [&points](Eigen::Index k) -> Eigen::Vector3d {
    return (points.col(k + 1) - points.col(k)).normalized();
  };
  for_each_twisted_span(rod, [&](const TwistedSpan& span, const Grip& first, const Grip& last) {
    const double moment = twist_angle(span, points) / span.compliance;
    const auto reaction_of = [&](const Grip& grip) -> GripReaction& {
      return reactions[static_cast<std::size_t>(&grip - rod.grips.data())];
    };
    reaction_of(first).torque -= moment * direction(span.first_segment);
    reaction_of(last).torque += moment * direction(span.last_segment);
  });
}

std::vector<GripReaction> grip_reactions(const Rod& rod, const Points& points) {
  Eigen::Matrix3Xd forces(3, points.cols());
  std::vector<GripReaction> reactions(rod.grips.size());
  grip_reactions(rod, points, forces, reactions);
  return reactions;
}

RodEnergy energy(const Rod& rod, const Points& points) {
  RodEnergy energy;
  energy.bending = bending_energy(points, rod.rest_lengths, rod.bending);
  energy.stretch = contraction_energy(points, rod.rest_lengths, rod.c_c);
  energy.load = -rod.loads.cwiseProduct(points).sum();
  for (const Wall& wall : rod.walls) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      energy.contact += wall_energy(wall, points.col(i));
    }
  }
  for (const Solid& solid : rod.solids) energy.contact += solid_energy(solid, points);
  for_each_grip_point(rod, GripHold::spring, [&](const Grip& grip, Eigen::Index k) {
    const Eigen::Vector3d offset = grip.targets.col(k) - points.col(grip.first_point + k);
    energy.contact += grip.stiffness * offset.squaredNorm() / 2;
  });
  for_each_twisted_span(rod,
                        [&](const TwistedSpan& span, const Grip& /*first*/, const Grip& /*last*/) {
                          energy.twist += twist_energy(span, points);
                        });
  return energy;
}

}  // namespace dlo::force_model
