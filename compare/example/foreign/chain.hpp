// A scene as a chain of hinges, for simulators of rigid bodies with joints.
//
// Segments are rods without mass, between the points of the scene's `force_model`; the first is
// held. A frame of a segment has its first axis along the segment. Needs JSON for Modern C++, no
// code of ours.

#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace foreign {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;  ///< w, x, y, z

inline Vector minus(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline double length(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
inline Quaternion inverse(const Quaternion& a) { return {a[0], -a[1], -a[2], -a[3]}; }

/// Returns the shortest rotation from direction a to direction b, which are not opposite.
inline Quaternion shortest_turn(const Vector& a, const Vector& b) {
  const double scale = length(a) * length(b);
  const Vector cross = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                        a[0] * b[1] - a[1] * b[0]};
  const double w = std::sqrt((1 + (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / scale) / 2);
  return {w, cross[0] / (2 * w * scale), cross[1] / (2 * w * scale), cross[2] / (2 * w * scale)};
}

/// Stiffnesses of a hinge [N m].
struct Hinge {
  double bend, twist;
};

/// Returns the energy of a hinge [J], by the rotation of its second segment in the frame of its
/// first: of the law `hooke` in bending, -4 k log cos(theta / 2), whose torque is 2 k tan(theta /
/// 2), and kt phi^2 / 2 in twist. A turn with the quaternion (w, x, y, z) is a twist phi about the
/// segment and the shortest turn theta between the segments, with
///     cos(theta / 2)^2 = w^2 + x^2,   tan(phi / 2) = x / w. (1)
inline double energy(const Hinge& hinge, const Quaternion& turn) {
  const double phi = 2 * std::atan(turn[1] / turn[0]);
  return -2 * hinge.bend * std::log1p(-(turn[2] * turn[2] + turn[3] * turn[3])) +
         hinge.twist * phi * phi / 2;
}

/// Returns the torque [N m] on the second segment, in its own frame: (1) differentiated with
///     d(w, x, y, z) = (w, x, y, z) (0, omega) / 2.
inline Vector torque(const Hinge& hinge, const Quaternion& turn) {
  const auto [w, x, y, z] = turn;
  const double square = w * w + x * x;
  const double phi = 2 * std::atan(x / w);
  const double by_w = (-4 * hinge.bend * w - 2 * hinge.twist * phi * x) / square;
  const double by_x = (-4 * hinge.bend * x + 2 * hinge.twist * phi * w) / square;
  return {(by_w * x - by_x * w) / 2, (by_w * y + by_x * z) / 2, (by_w * z - by_x * y) / 2};
}

struct Chain {
  std::vector<double> at;          ///< arc length of each point [m]; the first two are held
  std::vector<double> segment;     ///< lengths [m], of which the first is held
  std::vector<Hinge> hinges;       ///< between segments
  std::vector<Vector> force;       ///< on each point [N]: weight and loads
  Vector origin{}, first_point{};  ///< where the rod begins, and the first hinge [m]
  std::vector<Quaternion>
      frames;  ///< of each segment, to start with: not bent, or a circle's arc between clamps
  bool second_clamp = false;  ///< whether a second clamp holds the last segment
  Vector end{},
      last_hinge{};  ///< of a rod with a second clamp: where it ends, and its last hinge [m]

  /// Returns the initial rotation of a hinge's second segment in the frame of its first segment.
  [[nodiscard]] Quaternion turn(std::size_t hinge) const {
    return product(inverse(frames[hinge]), frames[hinge + 1]);
  }
};

/// Thrown for a scene that the chain does not support. `dlo suite` recognises it by the exit
/// status.
struct NotSupported : std::runtime_error {
  using std::runtime_error::runtime_error;
  static constexpr int exit_status = 3;
};

inline void refuse_unless(bool possible, const std::string& why) {
  if (!possible) throw NotSupported(why);
}

/// Throws NotSupported if a scene has properties that the chain does not model.
inline void check(const nlohmann::json& scene) {
  const nlohmann::json& model = scene.at("force_model");
  const nlohmann::json& rod = scene.at("rod");
  const nlohmann::json& grippers = scene.at("grippers");
  refuse_unless(!scene.contains("motion"), "only the shape at rest");
  refuse_unless(model.at("refused").is_null(), "the scene has no force_model");
  refuse_unless(model.at("law") == "hooke" && model.at("bookkeeping") == "consistent",
                "only the law hooke and the bookkeeping consistent");
  refuse_unless(rod.at("natural_curvature_per_m").empty() && scene.at("obstacles").empty(),
                "only a rod that is intrinsically straight, without obstacles");
  refuse_unless(grippers.size() <= 2, "only one or two clamps");
  for (const nlohmann::json& grip : grippers) {
    refuse_unless(grip.at("hold") == "clamp", "only clamps");
    refuse_unless(grip.at("at_m") ==
                          (&grip == &grippers.front() ? nlohmann::json(0.0) : rod.at("length_m")) &&
                      grip.at("direction") == grippers.front().at("direction"),
                  "the first clamp has to be at 0, a second one at the end and parallel to it");
  }
}

/// Returns the angle by which the second clamp rotates the rod's end about its direction [rad]; 0
/// for one clamp, or if the clamps hold no frames.
inline double roll(const nlohmann::json& scene) {
  const nlohmann::json& grippers = scene.at("grippers");
  if (grippers.size() < 2) return 0;
  if (grippers[1].at("frame").is_null()) {
    refuse_unless(!scene.at("plane_normal").is_null(), "clamps without a frame only in a plane");
    return 0;
  }
  refuse_unless(scene.at("rod").at("sections").empty(), "only rods without sections are twisted");
  return grippers[1].at("frame").at("roll_rad").get<double>() -
         grippers[0].at("frame").at("roll_rad").get<double>();
}

/// Returns frames along the points: transported without twist, and then rotated about the tangent
/// by an angle that grows evenly to the roll.
inline std::vector<Quaternion> frames(const std::vector<Vector>& points, const Vector& direction,
                                      double roll) {
  std::vector<Quaternion> result;
  Quaternion frame = shortest_turn({1, 0, 0}, direction);
  Vector before = direction;
  const std::size_t segments = points.size() - 1;
  for (std::size_t i = 0; i < segments; ++i) {
    const Vector along = minus(points[i + 1], points[i]);
    frame = product(shortest_turn(before, along), frame);
    before = along;
    const double half = roll / 2 * static_cast<double>(i) / static_cast<double>(segments - 1);
    result.push_back(product(frame, {std::cos(half), std::sin(half), 0, 0}));
  }
  return result;
}

inline Chain read_chain(const std::string& path) {
  std::ifstream file(path);
  const nlohmann::json scene = nlohmann::json::parse(file);
  check(scene);
  const nlohmann::json& model = scene.at("force_model");
  const nlohmann::json& grippers = scene.at("grippers");
  const auto points_of = [&](std::size_t grip) {
    return model.at("held").at(grip).at("points_m").get<std::vector<Vector>>();
  };
  Chain chain;
  chain.at = model.at("point_at_m").get<std::vector<double>>();
  chain.segment = model.at("segment_m").get<std::vector<double>>();
  chain.force = model.at("point_force_N").get<std::vector<Vector>>();
  chain.origin = grippers[0].at("position_m").get<Vector>();
  chain.first_point = points_of(0).at(1);
  chain.second_clamp = grippers.size() == 2;
  if (chain.second_clamp) {
    chain.end = grippers[1].at("position_m").get<Vector>();
    chain.last_hinge = points_of(1).at(0);
  }
  const nlohmann::json& GJ = scene.at("rod").at("torsional_stiffness_Nm2");
  const double EI = scene.at("rod").at("bending_stiffness_Nm2")[0].get<double>();
  for (const double bend : model.at("joint_stiffness_Nm")) {
    // If GJ is not given, nothing twists the rod, and the torsional stiffness has no effect.
    chain.hinges.push_back({bend, GJ.is_null() ? bend : bend * GJ.get<double>() / EI});
  }
  chain.frames = frames(model.at("start_m").get<std::vector<Vector>>(),
                        grippers[0].at("direction").get<Vector>(), roll(scene));
  return chain;
}

/// Writes the rod's axis. @param points  from the first hinge on
inline void write_shape(const std::string& path, const Chain& chain,
                        const std::vector<Vector>& points) {
  std::ofstream file(path);
  file.precision(12);
  const auto row = [&](const Vector& p, double s) {
    file << p[0] << ',' << p[1] << ',' << p[2] << ',' << s << '\n';
  };
  file << "x,y,z,s\n";
  row(chain.origin, 0);
  const std::size_t count = chain.at.size() - (chain.second_clamp ? 2 : 1);
  for (std::size_t i = 0; i < count; ++i) row(points.at(i), chain.at[i + 1]);
  if (chain.second_clamp) row(chain.end, (chain.at.back() + chain.at[chain.at.size() - 2]) / 2);
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

/// Runs a simulator as a program with the arguments SCENE SHAPE. Returns its exit status.
/// @param solve  returns the points of a chain at rest, as write_shape() writes them
inline int run(const std::string& name, int argc, char** argv,
               const std::function<std::vector<Vector>(const Chain&)>& solve) {
  try {
    if (argc != 3) throw std::runtime_error("usage: " + name + " SCENE SHAPE");
    const Chain chain = read_chain(argv[1]);
    write_shape(argv[2], chain, solve(chain));
    return 0;
  } catch (const NotSupported& scene) {
    std::cerr << name << ": " << scene.what() << '\n';
    return NotSupported::exit_status;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return 1;
  }
}

}  // namespace foreign
