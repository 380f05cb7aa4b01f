// Tests of tubes and rectangles: quantities computed from their sizes, against closed forms, tables
// and another series.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/reference.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "format/scene_document.hpp"
#include "scene/scene_problem.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

using std::numbers::pi;

const std::string flat_clamp = test::level_clamp;

std::string material_rod(const std::string& section) {
  return "[rod]\nlength = 1\nmaterial = { youngs_modulus = \"2 GPa\", density = 1200 }\n" +
         section + "\n";
}

Scene sectioned_scene(const std::string& section) {
  return parse_scene(material_rod(section) + flat_clamp, "my.toml");
}

TEST(RectangleTorsion, IsTwiceTheIntegralOfPrandtlsStressFunction) {
  // Double sine series: 256 a b / pi^6 times the sum of 1 / (m^2 n^2 (m^2/a^2 + n^2/b^2)) over odd
  // m and n; the truncation error beyond M is about 1 / M^3.
  constexpr int most = 1001;
  for (const double a : {1.0, 1.7, 3.0}) {
    double sum = 0;
    for (int m = 1; m <= most; m += 2) {
      for (int n = 1; n <= most; n += 2) {
        const double mm = static_cast<double>(m) * m;
        const double nn = static_cast<double>(n) * n;
        sum += 1 / (mm * nn * (mm / (a * a) + nn));
      }
    }
    const double J = 256 * a / std::pow(pi, 6) * sum;
    EXPECT_NEAR(rectangle_torsion_constant(a, 1) / J, 1, 1e-8) << a;
    EXPECT_EQ(rectangle_torsion_constant(1, a), rectangle_torsion_constant(a, 1));
  }
  EXPECT_NEAR(rectangle_torsion_constant(1e6, 1) / 1e6, 1.0 / 3, 1e-6);
  EXPECT_NEAR(rectangle_torsion_constant(4e-3, 2e-3) / rectangle_torsion_constant(4, 2), 1e-12,
              1e-25);
}

TEST(CrossSection, OfATubeIsARing) {
  const Scene tube = sectioned_scene("diameter = \"6 mm\"\ninner_diameter = \"4 mm\"");
  const double D = 6e-3;
  const double d = 4e-3;
  const double I = pi * (std::pow(D, 4) - std::pow(d, 4)) / 64;
  const double A = pi * (D * D - d * d) / 4;
  EXPECT_NEAR(tube.bending_stiffness() / (2e9 * I), 1, 1e-14);
  EXPECT_NEAR(tube.axial_stiffness() / (2e9 * A), 1, 1e-14);
  EXPECT_NEAR(tube.mass_per_length() / (1200 * A), 1, 1e-14);
  // G J = E / (2 (1 + nu)) 2 I
  EXPECT_NEAR(tube.assumed_torsional_stiffness() / (2e9 * I / 1.3), 1, 1e-14);
  EXPECT_FALSE(tube.has_material_directors());
  const Scene solid = sectioned_scene("diameter = \"6 mm\"\ninner_diameter = 0");
  EXPECT_EQ(solid.bending_stiffness(), sectioned_scene("diameter = \"6 mm\"").bending_stiffness());
  // If EI and mass are given alone, the section determines the axial stiffness.
  const Scene given = parse_scene(
      "[rod]\nlength = 1\nbending_stiffness = 0.1\nmass_per_length = 0.01\n"
      "diameter = \"6 mm\"\ninner_diameter = \"4 mm\"\n" +
          flat_clamp,
      "my.toml");
  EXPECT_NEAR(given.axial_stiffness() / (0.1 * A / I), 1, 1e-14);
}

TEST(CrossSection, OfAFlatStripHasTwoBendingStiffnessesAndSaintVenantsTorsion) {
  const Scene strip = sectioned_scene("width = \"10 mm\"\nthickness = \"2 mm\"");
  const double w = 10e-3;
  const double t = 2e-3;
  // The width is along d1: about d1 the thickness counts cubed.
  EXPECT_NEAR(strip.bending_stiffness() / (2e9 * w * t * t * t / 12), 1, 1e-14);
  ASSERT_TRUE(strip.bending_stiffness_2());
  EXPECT_NEAR(*strip.bending_stiffness_2() / (2e9 * t * w * w * w / 12), 1, 1e-14);
  EXPECT_NEAR(strip.axial_stiffness() / (2e9 * w * t), 1, 1e-14);
  EXPECT_NEAR(strip.mass_per_length() / (1200 * w * t), 1, 1e-14);
  EXPECT_TRUE(strip.has_two_stiffnesses());
  EXPECT_NEAR(strip.twisting_stiffness() / (2e9 / 2.6 * 0.2913 * w * t * t * t), 1, 2e-4);
  // Given stiffnesses override those of the section, and GJ is then computed from them.
  Scene given = strip;
  given.given_bending_stiffness = 0.1;
  EXPECT_FALSE(given.bending_stiffness_2());
  given.given_bending_stiffness_2 = 0.3;
  EXPECT_NEAR(given.twisting_stiffness(), 0.15 / 1.3, 1e-15);
}

TEST(CrossSection, OfASquareIsRoundInBendingAndNotInTorsion) {
  const Scene square = sectioned_scene("width = \"3 mm\"\nthickness = \"3 mm\"");
  EXPECT_FALSE(square.has_two_stiffnesses());
  EXPECT_TRUE(square.planar());
  EXPECT_NEAR(square.bending_stiffness() / (2e9 * std::pow(3e-3, 4) / 12), 1, 1e-14);
  EXPECT_NEAR(square.assumed_torsional_stiffness() / (2e9 / 2.6 * 0.140577 * std::pow(3e-3, 4)), 1,
              1e-5);
}

TEST(CrossSection, OfAStripBendsByItsThicknessWhereItsClampSaysSo) {
  // A weightless cantilever under a small load across its flat side: F l^3 / (3 EI).
  const auto tip = [](const std::string& roll) {
    const Scene scene = parse_scene(
        "gravity = [0, 0, 0]\n" + material_rod("width = \"10 mm\"\nthickness = \"2 mm\"") +
            flat_clamp + roll + "[[load]]\nat = 1\nforce = [0, 1e-6, 0]\n",
        "my.toml");
    return solve_reference(scene, Model::energy).sample(std::vector{1.0}).points(1, 0);
  };
  const double soft = 2e9 * 10e-3 * std::pow(2e-3, 3) / 12;
  EXPECT_NEAR(tip("roll = \"90 deg\"\n") / (1e-6 / (3 * soft)), 1, 1e-6);
  EXPECT_NEAR(tip("") / (1e-6 / (3 * soft * 25)), 1, 1e-6);
}

TEST(CrossSection, IsRefusedWhereItIsNone) {
  const auto expect_refused = [](const std::string& section, const std::vector<std::string>& parts,
                                 const std::string& rest = flat_clamp) {
    EXPECT_TRUE(has_all(test::scene_error(material_rod(section) + rest), parts));
  };
  expect_refused("diameter = \"4 mm\"\ninner_diameter = \"4 mm\"",
                 {"my.toml:5: rod.inner_diameter", "0 to less than diameter, 0.004 m"});
  expect_refused("diameter = \"4 mm\"\ninner_diameter = -1", {"rod.inner_diameter"});
  expect_refused("inner_diameter = \"1 mm\"", {"rod.diameter", "missing"});
  expect_refused("diameter = \"4 mm\"\nwidth = \"8 mm\"\nthickness = \"1 mm\"",
                 {"rod.diameter", "given besides width"});
  expect_refused("inner_diameter = \"4 mm\"\nthickness = \"1 mm\"",
                 {"rod.inner_diameter", "given besides thickness"});
  expect_refused("width = \"8 mm\"", {"rod.thickness", "missing", "beside width"});
  expect_refused("thickness = \"8 mm\"", {"rod.width", "missing"});
  expect_refused("width = 0\nthickness = \"1 mm\"", {"rod.width", "1e-9"});
  const std::string strip = "width = \"8 mm\"\nthickness = \"1 mm\"";
  const std::string plane = "[[obstacle]]\npoint = [0, -0.2, 0]\nnormal = [0, 1, 0]\n";
  expect_refused(strip, {"obstacle.touches", "touches = \"axis\""}, flat_clamp + plane);
  EXPECT_EQ(test::scene_error(material_rod(strip) + flat_clamp + plane + "touches = \"axis\"\n"),
            "no error");
  // No clamp determines the directions of a strip's axes.
  expect_refused(strip, {"rod.width", "no gripper holds the rod's frame"}, test::first_pin);
}

TEST(CrossSection, IsInTheDocumentWithWhatFollows) {
  const nlohmann::ordered_json tube =
      scene_document(sectioned_scene("diameter = \"6 mm\"\ninner_diameter = \"4 mm\"")).at("rod");
  EXPECT_DOUBLE_EQ(tube.at("inner_diameter_m"), 4e-3);
  EXPECT_GT(tube.at("assumed_torsional_stiffness_Nm2"), 0.0);
  const nlohmann::ordered_json strip =
      scene_document(sectioned_scene("width = \"10 mm\"\nthickness = \"2 mm\"")).at("rod");
  EXPECT_DOUBLE_EQ(strip.at("width_m"), 10e-3);
  EXPECT_DOUBLE_EQ(strip.at("thickness_m"), 2e-3);
  EXPECT_NEAR(strip.at("bending_stiffness_Nm2")[1].get<double>() /
                  strip.at("bending_stiffness_Nm2")[0].get<double>(),
              25, 1e-12);
}

}  // namespace
}  // namespace dlo::compare
