#include "dlo/compare/quantity.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "dlo/compare/error.hpp"

namespace dlo::compare {
namespace {

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

std::string message(const std::string& text, Dimension dimension) {
  try {
    (void)parse_quantity(text, dimension);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Quantity, SaysWhichUnitsAreAllowed) {
  EXPECT_EQ(message("210 GPA", Dimension::pressure),
            "unknown unit \"GPA\" in \"210 GPA\" (allowed: Pa, kPa, MPa, GPa, N/mm^2)");
  EXPECT_NE(message("2", Dimension::length).find("lacks a unit"), std::string::npos);
  EXPECT_NE(message("mm", Dimension::length).find("not a number"), std::string::npos);
  EXPECT_NE(message("", Dimension::length).find("not a number"), std::string::npos);
  EXPECT_NE(message("nan m", Dimension::length).find("not finite"), std::string::npos);
  EXPECT_NE(message("1e999 m", Dimension::length), "no error");
  EXPECT_NE(message("1 2 m", Dimension::length), "no error");
  EXPECT_NE(message("1 m", Dimension::number), "no error");
}

}  // namespace
}  // namespace dlo::compare
