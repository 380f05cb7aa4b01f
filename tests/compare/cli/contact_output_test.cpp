// Tests of the output for rods that touch an obstacle or themselves.

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "command_fixture.hpp"

namespace dlo::compare {
namespace {

class ContactCommand : public Command {
 protected:
  /// Writes the scene of a cable on a floor; a second floor is out of reach. Returns its path.
  std::string lying() {
    return write("lying.toml",
                 "[rod]\nlength = 0.6\ndiameter = \"4 mm\"\nmaterial = \"silicone\"\n"
                 "[[gripper]]\nat = 0\nposition = [0, 0.05, 0]\ndirection = \"0 deg\"\n"
                 "[[obstacle]]\npoint = [0, -9, 0]\nnormal = [0, 1, 0]\n"
                 "[[obstacle]]\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n");
  }
};

TEST_F(ContactCommand, CompareSaysWhatTouchesAsSolveDoes) {
  const json solved = json_of("solve " + lying());
  const json document = json_of("compare --no-modulus " + lying());
  const json& contacts = document.at("cases").at(0).at("contacts");
  ASSERT_EQ(contacts.size(), 1);
  EXPECT_EQ(contacts[0].at("obstacle"), 1);
  EXPECT_EQ(contacts[0].at("kind"), "lying");
  EXPECT_NEAR(contacts[0].at("from_m"), solved.at("contacts")[0].at("from_m"), 1e-8);
  EXPECT_GT(document.at("cases").at(0).at("budget").at("contact_m").get<double>(), 0);
}

// No model has friction: the shape is the one without it, and solve, compare and check report that
// friction is neglected, except for an obstacle that the rod does not touch.
TEST_F(ContactCommand, FrictionIsLeftOutAloud) {
  const std::string smooth = lying();
  const std::string text = read(smooth);
  const std::string rough = write("rough.toml", text + "friction = 0.3\n");
  const std::size_t second = text.rfind("[[obstacle]]");
  const std::string rough_below =
      write("below.toml", text.substr(0, second) + "friction = 0.3\n" + text.substr(second));
  for (const std::string model : {"energy", "chain", "force"}) {
    SCOPED_TRACE(model);
    const auto solve = [&](const std::string& format, const std::string& of) {
      return run(words({"solve --model", model, "--format", format, of}));
    };
    const json with = json::parse(solve("json", rough).out);
    const json without = json::parse(solve("json", smooth).out);
    EXPECT_EQ(with.at("neglected"), json({"friction"}));
    EXPECT_EQ(with.at("points_m"), without.at("points_m"));
    EXPECT_FALSE(without.contains("neglected"));
    EXPECT_TRUE(has_all(solve("text", rough).out,
                        {"\nneglected ", " friction\n", "friction could hold others"}));
    EXPECT_TRUE(has_all(solve("csv", rough).err, {"neglects the friction"}));
    EXPECT_FALSE(json::parse(solve("json", rough_below).out).contains("neglected"));
  }
  const json compared = json_of("compare --no-modulus " + rough);
  EXPECT_EQ(compared.at("cases").at(0).at("neglected"), json({"friction"}));
  const std::string shape = " --shape " + solved_file(smooth + " --samples 40");
  const std::string check = "check --no-modulus --tolerance 1% ";
  EXPECT_EQ(json_of(check + rough + shape).at("neglected"), json({"friction"}));
  EXPECT_TRUE(has_all(run("solve --explain " + rough).out, {"\n  friction "}));
}

// A cable next to a cylinder, a sphere, a capsule or a box: the models energy, chain and force
// agree within 0.2 % of the length, and in the first component of the body's force within 20 %.
TEST_F(ContactCommand, AllModelsTouchTheSameBodies) {
  const std::vector<std::string> bodies = {
      "shape = \"cylinder\"\npoint = [0.02, -0.05, 0]\naxis = [0, 0, 1]\nradius = \"2 cm\"\n",
      "shape = \"sphere\"\npoint = [0.02, -0.05, 0]\nradius = \"2 cm\"\n",
      "shape = \"capsule\"\npoint = [0.02, -0.05, 0]\naxis = [0, 0, 1]\nlength = 0.1\n"
      "radius = \"2 cm\"\n",
      "shape = \"box\"\npoint = [0, -0.03, 0]\nsize = [0.08, 0.1, 0.1]\n"};
  for (const std::string& body : bodies) {
    SCOPED_TRACE(body);
    const auto solve = [&](const std::string& model, int points) {
      std::string text =
          "[rod]\nlength = 0.6\ndiameter = \"4 mm\"\nmaterial = \"silicone\"\n"
          "[[gripper]]\nat = 0\nposition = [0, 0.05, 0]\ndirection = \"0 deg\"\n"
          "[force_model]\nlaw = \"hooke\"\nbookkeeping = \"consistent\"\npoints = ";
      text.append(std::to_string(points)).append("\n[[obstacle]]\n").append(body);
      std::string line = "solve --format json --samples 13 --model ";
      line.append(model).append(" ").append(write("body.toml", text));
      return json::parse(output_of(line));
    };
    const json energy = solve("energy", 16);
    ASSERT_EQ(energy.at("contacts").size(), 1);
    const double pushed = energy.at("obstacles")[0].at("force_N")[0].get<double>();
    EXPECT_GT(pushed, 0.01);
    for (const std::string model : {"chain", "force"}) {
      for (const int points : {64, 128}) {
        const json polygon = solve(model, points);
        EXPECT_LT(largest_coordinate_difference(polygon, energy), 2e-3 * 0.6)
            << model << " with " << points;
        const double force = polygon.at("obstacles")[0].at("force_N")[0].get<double>();
        EXPECT_NEAR(force, pushed, 0.2 * pushed) << model << " with " << points;
        EXPECT_NEAR(force, -polygon.at("grippers")[0].at("force_N")[0].get<double>(), 1e-6);
      }
    }
  }
}

TEST_F(ContactCommand, SolveSaysWhereARodCrossesItself) {
  // The rod has no load; its natural curvature alone bends it by more than one turn.
  const std::string loop =
      write("loop.toml",
            "gravity = [0, 0, 0]\n[rod]\nlength = 1\ndiameter = \"2 mm\"\nmaterial = \"nitinol\"\n"
            "natural_curvature = \"9 1/m\"\n"
            "[[gripper]]\nat = 0\nposition = [0, 0, 0]\ndirection = \"0 deg\"\n");
  const json document = json_of("solve " + loop);
  ASSERT_TRUE(document.contains("self_crossing"));
  const json& crossing = document.at("self_crossing");
  EXPECT_LT(crossing.at("distance_m").get<double>(), 2e-3);
  EXPECT_NEAR(crossing.at("s_m")[1].get<double>() - crossing.at("s_m")[0].get<double>(),
              2 * M_PI / 9, 0.02);
  EXPECT_TRUE(has_none(run("solve " + lying()).out, {"crossing"}));
}

}  // namespace
}  // namespace dlo::compare
