#include "toml/quantity.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <string>

#include "../../says.hpp"
#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

using test::error_of;
using test::says;

std::string message(const std::string& text, Dimension dimension) {
  return error_of<InputError>([&] { return parse_quantity(text, dimension); });
}

/// Unit with its factor to the SI unit, computed from its prefixes by hand.
struct UnitCase {
  Dimension dimension;
  const char* unit;
  double in_one_si;  ///< how many of it one SI unit is, or
  double si_in_one;  ///< how many SI units one of it is; the other is none
};

constexpr double none = 0;
constexpr UnitCase unit_cases[] = {
    {Dimension::length, "m", 1, none},
    {Dimension::length, "cm", 100, none},
    {Dimension::length, "mm", 1000, none},
    {Dimension::length, "um", 1e6, none},
    {Dimension::angle, "rad", 1, none},
    {Dimension::angle, "deg", 180 / 3.141592653589793, none},
    {Dimension::pressure, "Pa", 1, none},
    {Dimension::pressure, "kPa", none, 1000},
    {Dimension::pressure, "MPa", none, 1000.0 * 1000},
    {Dimension::pressure, "GPa", none, 1000.0 * 1000 * 1000},
    {Dimension::pressure, "N/mm^2", none, 1000.0 * 1000},  // a square metre has 1000^2 mm^2
    {Dimension::density, "kg/m^3", 1, none},
    {Dimension::density, "kg/dm^3", none, 10.0 * 10 * 10},           // dm^3 in a m^3
    {Dimension::density, "g/cm^3", none, 100.0 * 100 * 100 / 1000},  // cm^3 in a m^3, g in a kg
    {Dimension::force, "N", 1, none},
    {Dimension::force, "mN", 1000, none},
    {Dimension::force, "kN", none, 1000},
    {Dimension::force_per_length, "N/m", 1, none},
    {Dimension::force_per_length, "mN/m", 1000, none},
    {Dimension::force_per_length, "kN/m", none, 1000},
    {Dimension::force_per_length, "N/mm", none, 1000},
    {Dimension::torque, "N m", 1, none},
    {Dimension::torque, "mN m", 1000, none},
    {Dimension::torque, "N mm", 1000, none},
    {Dimension::torque, "kN m", none, 1000},
    {Dimension::acceleration, "m/s^2", 1, none},
    {Dimension::velocity, "m/s", 1, none},
    {Dimension::velocity, "mm/s", 1000, none},
    {Dimension::velocity, "km/h", 3.6, none},
    {Dimension::curvature, "1/m", 1, none},
    {Dimension::curvature, "1/cm", none, 100},
    {Dimension::curvature, "1/mm", none, 1000},
    {Dimension::foundation, "N/m^2", 1, none},
    {Dimension::foundation, "N/mm^2", none, 1000.0 * 1000},
    {Dimension::section_stiffness, "N m^2", 1, none},
    {Dimension::section_stiffness, "mN m^2", 1000, none},
    {Dimension::section_stiffness, "kN m^2", none, 1000},
    {Dimension::section_stiffness, "N cm^2", 100.0 * 100, none},
    {Dimension::section_stiffness, "N mm^2", 1000.0 * 1000, none},
    {Dimension::joint_stiffness, "N m/rad", 1, none},
    {Dimension::joint_stiffness, "N m", 1, none},
    {Dimension::joint_stiffness, "mN m/rad", 1000, none},
    {Dimension::joint_stiffness, "N mm/rad", 1000, none},
    {Dimension::joint_stiffness, "N mm", 1000, none},
    {Dimension::joint_stiffness, "N m/deg", none, 180 / 3.141592653589793}};

TEST(Quantity, EveryUnitHasItsFactor) {
  std::map<Dimension, std::string> tested;
  for (const UnitCase& unit : unit_cases) {
    const double expected = unit.si_in_one > 0 ? 3 * unit.si_in_one : 3 / unit.in_one_si;
    EXPECT_NEAR(parse_quantity(std::string("3 ") + unit.unit, unit.dimension), expected,
                1e-15 * expected)
        << unit.unit;
    std::string& list = tested[unit.dimension];
    list += (list.empty() ? "" : ", ") + std::string(unit.unit);
  }
  // A unit that is added is added here too.
  for (const Dimension dimension :
       {Dimension::number, Dimension::length, Dimension::angle, Dimension::pressure,
        Dimension::density, Dimension::force, Dimension::acceleration, Dimension::curvature,
        Dimension::foundation, Dimension::section_stiffness, Dimension::joint_stiffness,
        Dimension::force_per_length, Dimension::torque, Dimension::velocity}) {
    EXPECT_EQ(tested[dimension], known_units(dimension));
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
  EXPECT_DOUBLE_EQ(parse_quantity("210 GPa", Dimension::pressure), 210e9);
  EXPECT_DOUBLE_EQ(parse_quantity("210000 N/mm^2", Dimension::pressure), 210e9);
  EXPECT_DOUBLE_EQ(parse_quantity("2mm", Dimension::length), 2e-3);
  EXPECT_DOUBLE_EQ(parse_quantity("  5e1 cm ", Dimension::length), 0.5);
  EXPECT_DOUBLE_EQ(parse_quantity("-180 deg", Dimension::angle), -std::numbers::pi);
  EXPECT_DOUBLE_EQ(parse_quantity("+7.9 kg/dm^3", Dimension::density), 7900);
  EXPECT_DOUBLE_EQ(parse_quantity("0.005 1/mm", Dimension::curvature), 5);
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
  // A blank is a product.
  EXPECT_EQ(message("3 m m", Dimension::length).find("unknown unit"), 0U);
  EXPECT_EQ(message("3 m N", Dimension::force).find("unknown unit"), 0U);
}

TEST(Quantity, SaysWhichUnitsAreAllowed) {
  EXPECT_EQ(message("210 GPA", Dimension::pressure),
            "unknown unit \"GPA\" in \"210 GPA\" (allowed: Pa, kPa, MPa, GPa, N/mm^2)");
  EXPECT_TRUE(says(message("2", Dimension::length), {"lacks a unit"}));
  EXPECT_TRUE(says(message("mm", Dimension::length), {"not a number"}));
  EXPECT_TRUE(says(message("", Dimension::length), {"not a number"}));
  EXPECT_TRUE(says(message("nan m", Dimension::length), {"not finite"}));
  EXPECT_NE(message("1e999 m", Dimension::length), "no error");
  EXPECT_NE(message("1 2 m", Dimension::length), "no error");
  EXPECT_NE(message("1 m", Dimension::number), "no error");
}

}  // namespace
}  // namespace dlo::compare
