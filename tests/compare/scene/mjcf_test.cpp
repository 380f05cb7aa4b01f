// Tests of scenes made from MuJoCo models (data/mujoco), compared with the meaning of their
// elements in MuJoCo's documentation.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "base/input_file.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_file.hpp"
#include "explain/segment_starts.hpp"
#include "scene_text.hpp"
#include "scenes.hpp"

namespace dlo::compare {
namespace {

using std::numbers::pi;

Scene mjcf_model(const std::string& name) { return load_scene(DLO_DATA "/mujoco/" + name); }

std::string mjcf_text(const std::string& name) { return read_file(DLO_DATA "/mujoco/" + name); }

/// Compares with the accuracy to which files are rounded.
void expect_near(double value, double expected) {
  EXPECT_NEAR(value, expected, 1e-5 * std::abs(expected));
}

TEST(Mjcf, ACompositeCableHasTheStiffnessOfItsPlugin) {
  const Scene scene = mjcf_model("composite.xml");
  EXPECT_EQ(scene.name, "composite cable");
  expect_near(scene.length, 1);
  expect_near(scene.bending_stiffness(), 120e6 * pi / 4 * std::pow(0.004, 4));
  expect_near(*scene.torsional_stiffness, 46e6 * pi / 2 * std::pow(0.004, 4));
  // A capsule: the cylinder between the middles of its caps, and a sphere.
  const double capsule = pi * 0.004 * 0.004 * 0.05 + 4 * pi / 3 * std::pow(0.004, 3);
  expect_near(scene.mass(), 20 * 1150 * capsule);
  EXPECT_EQ(scene.gravity, Eigen::Vector3d(0, 0, -9.81));
  ASSERT_EQ(scene.grippers.size(), 1U);
  EXPECT_EQ(scene.grippers[0].position, Eigen::Vector3d(0, 0, 1));
  EXPECT_LT((*scene.grippers[0].direction - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  ASSERT_TRUE(scene.model);
  EXPECT_EQ(scene.model->segments, 20);
  EXPECT_EQ(scene.model->first_body, 2);
  EXPECT_EQ(scene.model->bodies, 22);
}

TEST(Mjcf, AChainOfBallJointsHasItsSpringsTimesASegment) {
  const Scene scene = mjcf_model("chain.xml");
  const double EI = 120e6 * pi / 64 * std::pow(0.008, 4);
  expect_near(scene.bending_stiffness(), EI);
  expect_near(*scene.torsional_stiffness, EI);
  expect_near(scene.mass(), 1150 * pi * 0.004 * 0.004);
  expect_near(scene.diameter, 0.008);
}

TEST(Mjcf, HingesFramesAndRadiansAreRead) {
  const Scene scene = mjcf_model("hinges.xml");
  expect_near(scene.length, 16 * 0.04);
  expect_near(scene.bending_stiffness(), 0.05 * 0.04);
  EXPECT_FALSE(scene.torsional_stiffness);
  expect_near(scene.mass(), 16 * 0.0016);  // mass of the inertials, not of the geoms
  EXPECT_EQ(scene.grippers.at(0).position, Eigen::Vector3d(0.2, 0, 1.5));
  const Eigen::Vector3d upwards(std::cos(pi / 6), 0, std::sin(pi / 6));
  EXPECT_LT((*scene.grippers[0].direction - upwards).norm(), 1e-9);
  EXPECT_TRUE(scene.obstacles.empty());
  // A geom with which the rod's geoms collide is an obstacle.
  std::string text = mjcf_text("hinges.xml");
  for (std::size_t at = text.find(" contype=\"0\""); at != std::string::npos;
       at = text.find(" contype=\"0\"")) {
    text.erase(at, std::string(" contype=\"0\" conaffinity=\"0\"").size());
  }
  const Scene touching = parse_scene(text, "touching.xml");
  ASSERT_EQ(touching.obstacles.size(), 1U);
  EXPECT_EQ(touching.obstacles[0].friction, 1);  // the larger one counts
  EXPECT_TRUE(touching.obstacles[0].body.is_half_space());
}

TEST(Mjcf, ConstraintsAreGrippers) {
  const Scene scene = mjcf_model("two_constraints.xml");
  ASSERT_EQ(scene.grippers.size(), 2U);
  const Gripper& clamp = scene.grippers[0];
  const Gripper& pin = scene.grippers[1];
  EXPECT_EQ(clamp.at, 0);
  EXPECT_TRUE(clamp.direction);
  EXPECT_FALSE(clamp.frame);  // in its reference pose it holds no twist
  EXPECT_EQ(pin.at, scene.length);
  EXPECT_FALSE(pin.direction);
  expect_near(pin.position.x(), 0.405094);
  EXPECT_FALSE(scene.naturally_bent());  // flat
  const Scene curved =
      parse_scene(replaced(mjcf_text("two_constraints.xml"), "\"true\"/>\n      </instance>",
                           "\"false\"/></instance>"),
                  "curved.xml");
  // An arc of 2.2 rad.
  EXPECT_NEAR(curved.natural_curvature().norm(), 2.2 / curved.length, 0.02 * 2.2);
}

TEST(Mjcf, AWeldIsWhereItsRelposePutsTheBody) {
  const std::string weld = "<weld body1=\"B_first\" body2=\"hand\"/>";
  // The hand is in the first body's frame at x = 0.1, turned by 90 degrees about z: that body's x
  // is the hand's -y, so that it is at (0, 0.1, 0) in the world, and points to -y.
  const Scene scene =
      parse_scene(replaced(mjcf_text("two_constraints.xml"), weld,
                           "<weld body1=\"B_first\" body2=\"hand\" relpose=\"0.1 0 0 1 0 0 1\"/>"),
                  "moved.xml");
  EXPECT_LT((scene.grippers.at(0).position - Eigen::Vector3d(0, 0.1, 0)).norm(), 1e-9);
  EXPECT_LT((*scene.grippers[0].direction - Eigen::Vector3d(0, -1, 0)).norm(), 1e-9);
}

TEST(Mjcf, CapsCountAsMassAndNotAsLength) {
  const Scene scene = mjcf_model("capsule_caps.xml");
  expect_near(scene.length, 12 * 0.04);
  expect_near(scene.mass(), 12 * 1000 * (pi * 1e-4 * 0.04 + 4 * pi / 3 * 1e-6));
  expect_near(scene.bending_stiffness(), 0.2 * 0.04);
  EXPECT_EQ(scene.gravity, Eigen::Vector3d(2, 0, -9.6));
}

/// The points of data/mujoco/chain.xml as computed by MuJoCo 3.14: data/shapes/mujoco_right.csv.
TEST(Mjcf, MuJoCosOwnPointsPassWithoutTheirLastEnd) {
  const Scene scene = mjcf_model("chain.xml");
  MeasuredShape shape = load_shape(DLO_DATA "/shapes/mujoco_right.csv");
  ASSERT_EQ(shape.points.cols(), 21);
  const Eigen::Vector3d end = shape.points.col(20);
  shape.points.conservativeResize(Eigen::NoChange, 20);
  const MeasuredShape whole = complete_segment_starts(scene, shape);
  ASSERT_EQ(whole.points.cols(), 21);
  // The angle of the last joint is extrapolated as a quarter of the angle before it. The error is
  // below the angle itself, w h^2 / 2 / (EI / h), with w l = 0.567 N.
  EXPECT_LT((whole.points.col(20) - end).norm(), 0.05 * 0.567 * 0.05 * 0.05 / 2 * 0.05 / 0.02413);
  // All bodies of the model. The first one is the world, whose position differs from the start of
  // the first segment.
  MeasuredShape all = shape;
  all.points.resize(3, 21);
  all.points << Eigen::Vector3d(0, 0, 0.3), shape.points;
  EXPECT_EQ(complete_segment_starts(scene, all).points.cols(), 21);
  EXPECT_EQ(complete_segment_starts(scene, all).points.col(0), shape.points.col(0));
}

struct Refused {
  const char* file;
  std::string piece, other;
  std::vector<std::string> message;
};

TEST(Mjcf, WhatARodCannotSayIsNamed) {
  const std::vector<Refused> cases = {
      {"chain.xml", "stiffness=", "stifness=", {":4: <joint>", "stifness", "stiffness?"}},
      {"chain.xml", "type=\"ball\"", "type=\"slide\"", {"<joint> type: ", "slide", "allowed"}},
      {"chain.xml", "<worldbody>", "<include file=\"a.xml\"/><worldbody>", {"<include>", "follow"}},
      {"chain.xml",
       "<mujoco",
       "<!DOCTYPE a [<!ENTITY b \"c\">]>\n<mujoco",
       {":1: a document type"}},
      {"chain.xml",
       "<joint/><geom/>",
       "<joint/><geom/><body pos=\"0 1 0\"><joint/></body>",
       {"a branch"}},
      {"chain.xml", "name=\"B_2\" pos=\"0.05", "name=\"B_2\" pos=\"0.06", {"\"B_2\"", "long"}},
      {"chain.xml", "</worldbody>", "</worldbody><tendon/>", {"<tendon>", "allowed"}},
      {"hinges.xml", "<joint type=\"hinge\" axis=\"0 0 1\" stiffness=\"0.05\"/>", "", {"axis"}},
      {"hinges.xml", "axis=\"0 1 0\"", "axis=\"1 1 0\"", {"<joint> axis = \"1 1 0\"", "oblique"}},
      {"hinges.xml", "-9.81\"", "-9.81 nan\"", {"<option> gravity"}},
      {"hinges.xml", "radian", "grad", {":3: <compiler> angle = \"grad\"", "degree, radian"}},
      {"composite.xml", "key=\"bend\"", "key=\"bent\"", {"<config> key = \"bent\"", "bend?"}},
      {"composite.xml", "count=\"21 1 1\"", "count=\"1e9\"", {"<composite> count", "1000"}},
      {"composite.xml", "bend\" value=\"120e6\"", "bend\" value=\"0\"", {"no spring"}},
      {"two_constraints.xml", "body1=\"B_first\"", "body1=\"B_99\"", {"<weld> body1", "no such"}},
      {"two_constraints.xml", "site2=\"hook\"", "site2=\"S_first\"", {"with itself"}},
  };
  for (const Refused& bad : cases) {
    const std::string text = replaced(mjcf_text(bad.file), bad.piece, bad.other);
    const std::string message = error_of<InputError>([&] { return parse_scene(text, "mine.xml"); });
    EXPECT_EQ(message.rfind("mine.xml:", 0), 0U) << message;
    EXPECT_TRUE(has_none(message, {"\n"}));
    EXPECT_TRUE(has_all(message, bad.message));
  }
}

TEST(Mjcf, AllRefusalsOfAFileAreInOneMessage) {
  std::string text = replaced(mjcf_text("chain.xml"), "stiffness=", "stifness=");
  text = replaced(text, "</worldbody>", "</worldbody><tendon/>");
  text = replaced(text, "<mujoco", "<mujoco colour=\"red\"");
  const std::string message = error_of<InputError>([&] { return parse_scene(text, "mine.xml"); });
  EXPECT_TRUE(has_all(message, {"mine.xml:4: <joint>", "<tendon>", "<mujoco> colour", "; "}));
  EXPECT_TRUE(has_none(message, {"\n"}));
}

/// Actuators, sensors, sites and bodies without mass have no part in a shape at rest.
TEST(Mjcf, PartsWithoutEffectAtRestAreIgnoredAndListed) {
  const Scene plain = mjcf_model("chain.xml");
  std::string text = replaced(mjcf_text("chain.xml"), "</worldbody>",
                              "</worldbody><actuator><motor name=\"m\" joint=\"j\"/></actuator>"
                              "<sensor><jointpos joint=\"j\"/><jointvel joint=\"j\"/></sensor>");
  text = replaced(text, "<joint/><geom/>",
                  "<joint/><geom/><site name=\"mark\"/><body name=\"spot\"/>");
  const Scene scene = parse_scene(text, "mine.xml");
  EXPECT_EQ(scene.bending_stiffness(), plain.bending_stiffness());
  EXPECT_EQ(scene.mass(), plain.mass());
  EXPECT_EQ(scene.model->segments, plain.model->segments);
  EXPECT_TRUE(has_all(fmt::format("{}", fmt::join(scene.model->notes, "\n")),
                      {"ignored: 1 actuator, 2 sensors, 1 site", "\"spot\" is ignored"}));
}

/// A slide or free joint of the first body is ignored: if nothing else holds the cable, its first
/// body is clamped at its pose in the model.
TEST(Mjcf, SlideAndFreeJointsOfTheBaseAreIgnored) {
  for (const char* joint : {"<freejoint/>", "<joint type=\"slide\" axis=\"1 0 0\"/>"}) {
    const Scene scene =
        parse_scene(replaced(mjcf_text("capsule_caps.xml"), "<body name=\"b0\" pos=\"0 0 0.6\">",
                             std::string("<body name=\"b0\" pos=\"0 0 0.6\">") + joint),
                    "mine.xml");
    const Scene fixed = mjcf_model("capsule_caps.xml");
    ASSERT_EQ(scene.grippers.size(), 1U);
    EXPECT_EQ(scene.grippers[0].position, fixed.grippers[0].position);
    EXPECT_EQ(scene.grippers[0].direction, fixed.grippers[0].direction);
    EXPECT_TRUE(has_all(scene.model->notes.front(), {"\"b0\" is ignored", "fixed"}));
  }
}

/// A spring k between segments of length h stands for EI = k h on the halves of both.
TEST(Mjcf, ACableThatIsNotUniformHasSections) {
  const Scene plain = mjcf_model("chain.xml");
  const double h = plain.length / 20;
  std::string text =
      replaced(mjcf_text("chain.xml"), "<joint/><geom/>", "<joint stiffness=\"9\"/><geom/>");
  const Scene stiff = parse_scene(text, "mine.xml");
  ASSERT_EQ(stiff.sections.size(), 2U);
  EXPECT_NEAR(stiff.sections[0].to, 1.5 * h, 1e-12);
  expect_near(stiff.sections[0].bending_stiffness, 9 * h);
  expect_near(stiff.sections[1].bending_stiffness, plain.bending_stiffness());
  expect_near(stiff.mass(), plain.mass());
  text = replaced(mjcf_text("chain.xml"), "<joint/><geom/>", "<joint/><geom mass=\"7\"/>");
  const Scene heavy = parse_scene(text, "mine.xml");
  ASSERT_EQ(heavy.sections.size(), 3U);
  EXPECT_NEAR(heavy.sections[1].from, h, 1e-12);
  EXPECT_NEAR(heavy.sections[1].to, 2 * h, 1e-12);
  expect_near(heavy.sections[1].mass_per_length, 7 / h);
  expect_near(heavy.mass(), plain.mass() * 19 / 20 + 7);
}

}  // namespace
}  // namespace dlo::compare
