#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mjcf/mjcf_world.hpp"

namespace dlo::compare {

/// A body of a cable: rigid, from its joint to the next one's.
struct MjcfSegment {
  std::size_t body = 0;
  Eigen::Vector3d begin = Eigen::Vector3d::Zero();  ///< in the body [m]
  Eigen::Vector3d end = Eigen::Vector3d::Zero();    ///< in the body [m]
  double at = 0;                                    ///< arc length of its begin [m]

  [[nodiscard]] double length() const { return (end - begin).norm(); }
  [[nodiscard]] Eigen::Vector3d direction() const { return (end - begin).normalized(); }
};

/// A part of a cable with the same stiffness and mass per length.
struct MjcfSection {
  double from = 0, to = 0;         ///< arc lengths [m]
  double bending_stiffness = 0;    ///< EI [N m^2]
  double torsional_stiffness = 0;  ///< GJ [N m^2]; 0: none
  double mass_per_length = 0;      ///< [kg/m]
};

/// The cable of a model, as a rod.
struct MjcfChain {
  std::vector<MjcfSegment> segments;
  double length = 0;               ///< [m]
  double mass = 0;                 ///< [kg]
  double bending_stiffness = 0;    ///< EI [N m^2], the mean of the joints
  double torsional_stiffness = 0;  ///< GJ [N m^2], the mean of the joints; 0: none, of hinges
  /// Empty if all segments have the same mass and all joints the same springs; else the whole rod.
  std::vector<MjcfSection> sections;
  double diameter = 0;  ///< of its geoms [m]; 0: they are not round
  double spring = 0;    ///< of a joint between two segments [N m/rad]
  /// Axis of hinges that bend it in one plane only, in the world; zero: it bends everywhere.
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();
  bool is_curved = false;          ///< where it is free of stress
  std::string words;               ///< "a composite cable", "a chain of bodies with ball joints"
  std::vector<std::string> notes;  ///< what was assumed

  /// Place in `segments`; none of a body that is not among them.
  [[nodiscard]] std::optional<std::size_t> segment_of(std::size_t body) const;
};

/// Finds the one chain of bodies and what a rod like it has.
/// @throws InputError naming file, line, element and attribute of what no rod has
[[nodiscard]] MjcfChain find_mjcf_chain(const MjcfAttributes& attributes, const MjcfWorld& world);

/// A gripper of a cable.
struct MjcfHold {
  double at = 0;                                       ///< arc length [m]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<Eigen::Vector3d> direction;            ///< of a clamp, unit
  std::optional<Eigen::Vector3d> d1;  ///< of a clamp that turns it from its reference
  std::string words;                  ///< "the first body is fixed"
};

/// What holds a cable: a first body that is fixed or jointed to what is, and constraints weld and
/// connect to what does not move.
/// @param constrained  whether constraints count;  @param notes  on what was assumed, added to
/// @throws InputError naming file, line, element and attribute of what no gripper does
[[nodiscard]] std::vector<MjcfHold> find_mjcf_holds(const MjcfAttributes& attributes,
                                                    const MjcfWorld& world, const MjcfChain& chain,
                                                    bool constrained,
                                                    std::vector<std::string>& notes);

/// The geoms of what does not move that collide with a cable, as tables [[obstacle]] of a scene.
/// @param notes  on such as are neglected, added to
/// @throws InputError naming file, line and element of one that no obstacle is like
[[nodiscard]] std::string mjcf_obstacles(const MjcfAttributes& attributes, const MjcfWorld& world,
                                         const MjcfChain& chain, const std::vector<MjcfHold>& holds,
                                         std::vector<std::string>& notes);

}  // namespace dlo::compare
