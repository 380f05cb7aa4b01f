#include "mjcf/mjcf_geom.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/number.hpp"

namespace dlo::compare {
namespace {

using Type = MjcfGeom::Type;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
/// Density of water, MuJoCo's default [kg/m^3].
constexpr double default_density = 1000;

Type type_of(const MjcfNode& node) {
  constexpr Type types[] = {Type::sphere,    Type::plane, Type::capsule, Type::cylinder, Type::box,
                            Type::ellipsoid, Type::other, Type::other,   Type::other};
  return types[node.choice("type", {"sphere", "plane", "capsule", "cylinder", "box", "ellipsoid",
                                    "hfield", "mesh", "sdf"})];
}

/// Returns the number of half-sizes that define a geom.
std::size_t sizes_of(Type type) {
  // In the order of MjcfGeom::Type; 0 for `other`, the last one.
  constexpr std::size_t sizes[static_cast<std::size_t>(Type::other) + 1] = {0, 1, 2, 3, 2, 3};
  return sizes[static_cast<std::size_t>(type)];
}

/// Reads half-sizes; the last `given` of them are optional, because fromto determines them.
Vector3d read_size(const MjcfNode& node, Type type, std::size_t given) {
  Vector3d size = Vector3d::Zero();
  const std::size_t count = sizes_of(type);
  if (count == 0) return size;
  const auto values = node.numbers("size", 0, 3);
  const std::size_t needed = count - given;
  if (!values || values->size() < needed) {
    node.fail("size", fmt::format("missing, or too few numbers (allowed: {}, > 0)", needed));
  }
  for (std::size_t i = 0; i < std::min(count, values->size()); ++i) {
    size[static_cast<Eigen::Index>(i)] = (*values)[i];
    if (i < needed && !((*values)[i] > 0)) {
      node.fail("size", "(allowed: numbers > 0)");
    }
  }
  return size;
}

/// Sets pose and half-length from two ends.
void span(const MjcfNode& node, const Vector3d& from, const Vector3d& to, MjcfGeom& geom) {
  const Vector3d axis = to - from;
  constexpr double shortest_geom = 1e-12;
  if (!(axis.norm() > shortest_geom)) {
    node.fail("fromto", "has no length (allowed: two points that are apart)");
  }
  geom.pose.linear() =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
  geom.pose.translation() = (from + to) / 2;
  // A box along z has its first two sizes perpendicular to z, as in MuJoCo.
  geom.size[geom.is_round() ? 1 : 2] = axis.norm() / 2;
}

/// Returns the volume [m^3]; that of a capsule is a cylinder and a sphere, its two caps; 0 for
/// planes and other geoms.
double volume_of(const MjcfGeom& geom) {
  const double r = geom.size[0];
  switch (geom.type) {
    case Type::sphere:
      return 4 * pi / 3 * r * r * r;
    case Type::capsule:
      return pi * r * r * 2 * geom.size[1] + 4 * pi / 3 * r * r * r;
    case Type::cylinder:
      return pi * r * r * 2 * geom.size[1];
    case Type::box:
      return 8 * geom.size.prod();
    case Type::ellipsoid:
      return 4 * pi / 3 * geom.size.prod();
    case Type::plane:
    case Type::other:
      break;
  }
  return 0;
}

int collision_bits(const MjcfNode& node, const char* attribute) {
  const std::optional<std::string> given = node.text(attribute);
  if (!given) return 1;
  const std::optional<int> bits = as_number<int>(*given);
  if (!bits) node.fail(attribute, "is no integer of 32 bits");
  return *bits;
}

void read_mass_and_contact(const MjcfNode& node, MjcfGeom& geom) {
  const std::optional<double> mass = node.number("mass");
  const double density = node.number("density").value_or(default_density);
  if (!(mass.value_or(0) >= 0)) node.fail("mass", "(allowed: 0 or more)");
  if (!(density >= 0)) node.fail("density", "(allowed: 0 or more)");
  if (node.choice("shellinertia", {"false", "true"}) == 1 && !mass) {
    node.fail("shellinertia", "of a mass that is not given (allowed: mass)");
  }
  geom.mass = mass.value_or(density * volume_of(geom));
  geom.contype = collision_bits(node, "contype");
  geom.conaffinity = collision_bits(node, "conaffinity");
  const auto friction = node.numbers("friction", 1, 3);
  if (friction) geom.friction = friction->front();
  if (!(geom.friction >= 0)) node.fail("friction", "(allowed: 0 or more)");
}

}  // namespace

Vector3d MjcfGeom::end(double sign) const {
  Eigen::Index axis = 2;
  double half = is_round() ? size[1] : 0;
  if (type == Type::box) half = size.maxCoeff(&axis);
  return pose * (sign * half * Vector3d::Unit(axis));
}

MjcfGeom read_mjcf_geom(const MjcfNode& node, const MjcfPose& at) {
  node.require_known();
  MjcfGeom geom{.type = type_of(node), .node = node.element};
  const auto ends = node.numbers("fromto", 6, 6);
  const bool has_ends = ends && sizes_of(geom.type) > 1;
  if (ends && !has_ends) {
    node.fail("fromto", "(allowed: of a capsule, cylinder, box or ellipsoid)");
  }
  geom.size = read_size(node, geom.type, has_ends ? 1 : 0);
  if (has_ends) {
    const std::vector<double>& v = *ends;
    if (!geom.is_round()) geom.size[1] = geom.size[1] > 0 ? geom.size[1] : geom.size[0];
    span(node, Vector3d(v[0], v[1], v[2]), Vector3d(v[3], v[4], v[5]), geom);
  } else {
    geom.pose = node.pose();
  }
  geom.pose = at * geom.pose;
  read_mass_and_contact(node, geom);
  return geom;
}

MjcfGeom read_composite_geom(const MjcfNode& node, double length) {
  node.require_known();
  for (const char* attribute :
       {"pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "fromto", "class"}) {
    if (node.element.attribute(attribute)) {
      node.fail(attribute, "of a composite's geom (allowed: none)");
    }
  }
  MjcfGeom geom{.type = type_of(node), .node = node.element};
  if (!geom.is_round()) {
    node.fail("type",
              "of a composite cable whose bending is that of a round rod (allowed: "
              "capsule, cylinder)");
  }
  geom.size = read_size(node, geom.type, 1);
  span(node, Vector3d::Zero(), length * Vector3d::UnitX(), geom);
  read_mass_and_contact(node, geom);
  return geom;
}

}  // namespace dlo::compare
