#include "dlo/force_model/rod.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "dlo/force_model/contraction.hpp"
#include "require.hpp"

namespace dlo::force_model {
namespace {

using Points = Eigen::Ref<const Eigen::Matrix3Xd>;

void check_grip(const Grip& grip, Eigen::Index points) {
  const auto held = static_cast<double>(grip.targets.cols());
  require(held == 1 || held == 2, "Rod", "points held by a grip", held, "1 or 2");
  require(grip.first_point >= 0 && grip.first_point + grip.targets.cols() <= points, "Rod",
          "first point of a grip", static_cast<double>(grip.first_point),
          "so that the grip's points exist");
  require(grip.targets.allFinite(), "Rod", "targets of a grip", grip.targets.norm(), "finite");
  if (grip.hold == GripHold::spring) require_positive("Rod", "grip stiffness", grip.stiffness);
}

/// A rigid grip exerts all that acts on its points, so no two may hold the same one.
void require_own_points(std::string_view function, const std::vector<Grip>& grips) {
  for (std::size_t i = 0; i < grips.size(); ++i) {
    if (grips[i].hold == GripHold::spring) continue;
    for (std::size_t j = 0; j < i; ++j) {
      if (grips[j].hold == GripHold::spring) continue;
      const Eigen::Index begin = std::max(grips[i].first_point, grips[j].first_point);
      const Eigen::Index end = std::min(grips[i].first_point + grips[i].targets.cols(),
                                        grips[j].first_point + grips[j].targets.cols());
      require(begin >= end, function, "point held by two rigid grips", static_cast<double>(begin),
              "held by one of them");
    }
  }
}

Eigen::Vector3d on_held_point(const Grip& grip, Eigen::Index k, const Points& points,
                              const Points& forces) {
  const Eigen::Index i = grip.first_point + k;
  if (grip.hold == GripHold::rigid) return -forces.col(i);
  return spring_force(grip.stiffness, grip.targets.col(k), points.col(i));
}

}  // namespace

bool is_planar(const Rod& rod) {
  const auto in_plane = [](const Grip& grip) { return (grip.targets.row(2).array() == 0).all(); };
  const auto upright = [](const Wall& wall) { return wall.normal.z() == 0; };
  return (rod.loads.row(2).array() == 0).all() &&
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
  for (const Wall& wall : rod.walls) check(wall);
  for (const Grip& grip : rod.grips) check_grip(grip, rod.points());
  require_own_points("Rod", rod.grips);
  if (rod.bending.natural_turns.size() > 0) {
    require(is_planar(rod), "Rod", "number of natural turns",
            static_cast<double>(rod.bending.natural_turns.size()),
            "0 unless loads, grips and walls lie in the plane z = 0");
  }
}

void total_forces(const Rod& rod, const Points& points, Eigen::Ref<Eigen::Matrix3Xd> forces) {
  require(forces.cols() == rod.loads.cols(), "total_forces", "columns of forces",
          static_cast<double>(forces.cols()), "the number of points");
  forces = rod.loads;  // (6)
  add_contraction_forces(points, rod.rest_lengths, rod.c_c, forces);
  add_bending_forces(points, rod.rest_lengths, rod.bending, forces);
  for (const Wall& wall : rod.walls) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      forces.col(i) += wall_force(wall, points.col(i));
    }
  }
  for (const Grip& grip : rod.grips) {
    if (grip.hold == GripHold::rigid) continue;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      const Eigen::Index i = grip.first_point + k;
      forces.col(i) += spring_force(grip.stiffness, grip.targets.col(k), points.col(i));
    }
  }
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
      const Eigen::Vector3d force = on_held_point(grip, k, points, forces);
      const Eigen::Vector3d arm = points.col(grip.first_point + k) - grip.reference;
      reaction.force += force;
      reaction.torque += arm.cross(force);
    }
    reactions[g] = reaction;
  }
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
  for (const Grip& grip : rod.grips) {
    if (grip.hold == GripHold::rigid) continue;
    for (Eigen::Index k = 0; k < grip.targets.cols(); ++k) {
      const Eigen::Vector3d offset = grip.targets.col(k) - points.col(grip.first_point + k);
      energy.contact += grip.stiffness * offset.squaredNorm() / 2;
    }
  }
  return energy;
}

}  // namespace dlo::force_model
