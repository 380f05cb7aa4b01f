#include "toml/quantity.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

std::string message(const std::string& text, Dimension dimension) {
  return error_of<InputError>([&] { return parse_quantity(text, dimension); });
}

/// The units of each dimension, in the order of messages, and how many SI units one of them is.
const std::vector<std::pair<Dimension, std::vector<std::pair<std::string, double>>>> unit_factors =
    {{Dimension::number, {}},
     {Dimension::length, {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}}},
     {Dimension::angle, {{"rad", 1}, {"deg", std::numbers::pi / 180}}},
     {Dimension::pressure, {{"Pa", 1}, {"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}, {"N/mm^2", 1e6}}},
     {Dimension::density, {{"kg/m^3", 1}, {"kg/dm^3", 1e3}, {"g/cm^3", 1e3}}},
     {Dimension::force, {{"N", 1}, {"mN", 1e-3}, {"kN", 1e3}}},
     {Dimension::force_per_length, {{"N/m", 1}, {"mN/m", 1e-3}, {"kN/m", 1e3}, {"N/mm", 1e3}}},
     {Dimension::torque, {{"N m", 1}, {"mN m", 1e-3}, {"N mm", 1e-3}, {"kN m", 1e3}}},
     {Dimension::acceleration, {{"m/s^2", 1}}},
     {Dimension::velocity, {{"m/s", 1}, {"mm/s", 1e-3}, {"km/h", 1 / 3.6}}},
     {Dimension::curvature, {{"1/m", 1}, {"1/cm", 1e2}, {"1/mm", 1e3}}},
     {Dimension::foundation, {{"N/m^2", 1}, {"N/mm^2", 1e6}}},
     {Dimension::section_stiffness,
      {{"N m^2", 1}, {"mN m^2", 1e-3}, {"kN m^2", 1e3}, {"N cm^2", 1e-4}, {"N mm^2", 1e-6}}},
     {Dimension::joint_stiffness,
      {{"N m/rad", 1},
       {"N m", 1},
       {"mN m/rad", 1e-3},
       {"N mm/rad", 1e-3},
       {"N mm", 1e-3},
       {"N m/deg", 180 / std::numbers::pi}}}};

TEST(Quantity, EveryUnitHasItsFactor) {
  for (const auto& [dimension, units] : unit_factors) {
    std::string list;
    for (const auto& [unit, factor] : units) {
      EXPECT_NEAR(parse_quantity("3 " + unit, dimension), 3 * factor, 3e-15 * factor) << unit;
      list += (list.empty() ? "" : ", ") + unit;
    }
    // This list must be extended when a unit is added.
    EXPECT_EQ(list, known_units(dimension));
  }
}

TEST(Quantity, NoUnitIsReadAsAnothersPrefix) {
  EXPECT_EQ(message("3 Mm", Dimension::length).find("unknown unit"), 0U);
  EXPECT_EQ(message("3 mPa", Dimension::pressure).find("unknown unit"), 0U);
  EXPECT_EQ(message("3 mm", Dimension::pressure).find("unknown unit"), 0U);
  EXPECT_EQ(message("3 kg/m^2", Dimension::density).find("unknown unit"), 0U);
  EXPECT_EQ(message("3 %", Dimension::number).find("unknown unit"), 0U);
}

TEST(Quantity, ConvertsToSi) {
  EXPECT_DOUBLE_EQ(parse_quantity("2mm", Dimension::length), 2e-3);
  EXPECT_DOUBLE_EQ(parse_quantity("  5e1 cm ", Dimension::length), 0.5);
  EXPECT_DOUBLE_EQ(parse_quantity("-180 deg", Dimension::angle), -std::numbers::pi);
  EXPECT_DOUBLE_EQ(parse_quantity("+7.9 kg/dm^3", Dimension::density), 7900);
  EXPECT_DOUBLE_EQ(parse_quantity("3", Dimension::number), 3);
}

TEST(Quantity, UnitsMayBeSpelledAsTheFieldDoes) {
  for (const char* text : {"3 Nm", "3Nm", "3 N*m", "3 N\xc2\xb7m"}) {
    EXPECT_DOUBLE_EQ(parse_quantity(text, Dimension::torque), 3) << text;
  }
  EXPECT_DOUBLE_EQ(parse_quantity("3 mNm^2", Dimension::section_stiffness), 3e-3);
  EXPECT_DOUBLE_EQ(parse_quantity("3 N*m\xc2\xb2", Dimension::section_stiffness), 3);
  EXPECT_DOUBLE_EQ(parse_quantity("3 Nm/rad", Dimension::joint_stiffness), 3);
  EXPECT_DOUBLE_EQ(parse_quantity("3 \xc2\xb5m", Dimension::length), 3e-6);
  EXPECT_DOUBLE_EQ(parse_quantity("180 \xc2\xb0", Dimension::angle), std::numbers::pi);
  // A blank between two units would mean their product.
  EXPECT_EQ(message("3 m m", Dimension::length).find("unknown unit"), 0U);
  EXPECT_EQ(message("3 m N", Dimension::force).find("unknown unit"), 0U);
}

TEST(Quantity, SaysWhichUnitsAreAllowed) {
  EXPECT_EQ(message("210 GPA", Dimension::pressure),
            "unknown unit \"GPA\" in \"210 GPA\" (allowed: Pa, kPa, MPa, GPa, N/mm^2)");
  EXPECT_TRUE(has_all(message("2", Dimension::length), {"lacks a unit"}));
  EXPECT_TRUE(has_all(message("mm", Dimension::length), {"not a number"}));
  EXPECT_TRUE(has_all(message("", Dimension::length), {"not a number"}));
  EXPECT_TRUE(has_all(message("nan m", Dimension::length), {"not finite"}));
  EXPECT_NE(message("1e999 m", Dimension::length), "no error");
  EXPECT_NE(message("1 2 m", Dimension::length), "no error");
  EXPECT_NE(message("1 m", Dimension::number), "no error");
}

}  // namespace
}  // namespace dlo::compare
