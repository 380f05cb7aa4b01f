// Tests of cables of layers: bounds of their stiffness.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/material.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/solve.hpp"
#include "scene_text.hpp"

namespace dlo::compare {
namespace {

double disc_moment(double diameter) { return std::numbers::pi * std::pow(diameter, 4) / 64; }

TEST(Layers, TubesAboutOneAxisAreAsStiffBondedAsFree) {
  const LayeredSection cable =
      layered_section({{.youngs_modulus = 100e9, .density = 8900, .outer_diameter = 1e-3},
                       {.youngs_modulus = 0.2e9, .density = 1400, .outer_diameter = 3e-3}});
  const double EI = 100e9 * disc_moment(1e-3) + 0.2e9 * (disc_moment(3e-3) - disc_moment(1e-3));
  EXPECT_NEAR(cable.bonded_bending_stiffness, EI, 1e-12 * EI);
  EXPECT_EQ(cable.free_bending_stiffness, cable.bonded_bending_stiffness);
  EXPECT_EQ(cable.free_torsional_stiffness, cable.bonded_torsional_stiffness);
  // Round: GJ = EI / (1 + nu).
  EXPECT_NEAR(cable.bonded_torsional_stiffness, EI / 1.3, 1e-12 * EI);
  EXPECT_NEAR(cable.axial_stiffness, std::numbers::pi / 4 * (100e9 * 1e-6 + 0.2e9 * 8e-6), 1e-6);
  EXPECT_NEAR(cable.mass_per_length, std::numbers::pi / 4 * (8900 * 1e-6 + 1400 * 8e-6), 1e-12);
  EXPECT_EQ(cable.outer_diameter, 3e-3);
}

TEST(Layers, SixStrandsAboutOneHaveTheirSteinerTerm) {
  const double E = 200e9;
  const double d = 1e-3;
  const Layer core{.youngs_modulus = E, .density = 7800, .strands = 1, .strand_diameter = d};
  const Layer ring{.youngs_modulus = E, .density = 7800, .strands = 6, .strand_diameter = d};
  const LayeredSection wire = layered_section({core, ring});
  // The bonded stiffness includes the distance y of each strand from the neutral axis.
  double bonded = E * disc_moment(d);
  for (int k = 0; k < 6; ++k) {
    const double y = d * std::sin(2 * std::numbers::pi * k / 6 + 0.3);
    bonded += E * (disc_moment(d) + std::numbers::pi * d * d / 4 * y * y);
  }
  EXPECT_NEAR(wire.bonded_bending_stiffness, bonded, 1e-12 * bonded);
  EXPECT_NEAR(wire.free_bending_stiffness, 7 * E * disc_moment(d), 1e-12 * bonded);
  EXPECT_NEAR(wire.bonded_bending_stiffness / wire.free_bending_stiffness, 55.0 / 7, 1e-12);
  EXPECT_EQ(wire.outer_diameter, 3 * d);
  EXPECT_NEAR(wire.axial_stiffness, 7 * E * std::numbers::pi * d * d / 4, 1e-6);
  // Three strands that touch each other have no core.
  const LayeredSection three =
      layered_section({{.youngs_modulus = E, .strands = 3, .strand_diameter = d}});
  EXPECT_NEAR(three.outer_diameter, d * (1 + 2 / std::sqrt(3)), 1e-15);
}

const std::string cable_head = "[rod]\nlength = 0.5\n";
const std::string cable_tail = test::level_clamp;
const std::string cable_layers =
    "layers = [{ strands = 1, strand_diameter = \"1 mm\", material = \"copper\" },\n"
    "          { strands = 6, strand_diameter = \"1 mm\", material = \"copper\" },\n"
    "          { outer_diameter = \"5 mm\", youngs_modulus = \"10 MPa\", density = 1200 }]\n";

TEST(Layers, ASceneTakesOneBoundAndStatesBoth) {
  const Scene bonded = parse_scene(cable_head + cable_layers + cable_tail, "my.toml");
  const Scene loose =
      parse_scene(cable_head + cable_layers + "layer_bound = \"free\"\n" + cable_tail, "my.toml");
  ASSERT_TRUE(bonded.layers && loose.layers);
  EXPECT_TRUE(bonded.layers->bonded);
  EXPECT_FALSE(loose.layers->bonded);
  EXPECT_EQ(bonded.bending_stiffness(), bonded.layers->bonded_bending_stiffness);
  EXPECT_EQ(loose.bending_stiffness(), bonded.layers->free_bending_stiffness);
  EXPECT_NEAR(bonded.axial_stiffness(), bonded.layers->axial_stiffness,
              1e-12 * bonded.axial_stiffness());
  EXPECT_EQ(bonded.mass_per_length(), loose.mass_per_length());
  EXPECT_EQ(bonded.torsional_stiffness, bonded.layers->bonded_torsional_stiffness);
  EXPECT_EQ(bonded.diameter, 5e-3);
  // The looser cable hangs lower.
  EXPECT_LT(solve(loose, Model::energy).shape.points.row(1).minCoeff(),
            solve(bonded, Model::energy).shape.points.row(1).minCoeff());
}

TEST(Layers, ScaleWithTheModulus) {
  Scene cable = parse_scene(cable_head + cable_layers + cable_tail, "my.toml");
  cable.scale_modulus(2);
  EXPECT_EQ(cable.bending_stiffness(), cable.layers->bonded_bending_stiffness);
  EXPECT_NEAR(cable.axial_stiffness(), cable.layers->axial_stiffness, 1e-6);
}

TEST(Layers, SayWhatIsWrong) {
  const auto refusal = [](const std::string& rod) {
    return test::scene_error(cable_head + rod + cable_tail);
  };
  const auto expect = [&](const std::string& rod, const std::string& message) {
    EXPECT_TRUE(has_all(refusal(rod), {message}));
  };
  const std::string core = "{ outer_diameter = 1e-3, material = \"copper\" }";
  expect("layers = [" + core + ", " + core + "]\n", "layer 2: outer_diameter");
  expect(
      "layers = [" + core + ", { strands = 7, strand_diameter = 1e-3, material = \"copper\" }]\n",
      "7 strands of 0.001 m do not fit side by side");
  expect("layers = [" + core + "]\ndiameter = 1e-3\n", "given besides diameter");
  expect("layers = [{ strands = 2, strand_diameter = 1e-3, material = \"copper\" }]\n",
         "2 strands do not bend alike");
  expect("diameter = 1e-3\nmaterial = \"copper\"\nlayer_bound = \"free\"\n",
         "rod.layers: missing, it is required beside layer_bound");
  const Layer fewer_than_none{.youngs_modulus = 1e9, .strands = -3, .strand_diameter = 1e-3};
  EXPECT_EQ(test::error_of<InputError>([&] { (void)layered_section({fewer_than_none}); }),
            "layer 1: strands = -3 (allowed: 0 or more)");
}

}  // namespace
}  // namespace dlo::compare
