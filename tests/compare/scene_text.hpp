#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "../helpers.hpp"
#include "../says.hpp"
#include "dlo/compare/error.hpp"
#include "dlo/compare/scene_file.hpp"

namespace dlo::test {

/// Returns a gripper at the beginning of the rod and the origin.
/// @param held  a direction or `hold = "pin"`
inline std::string gripper_text(const std::string& held) {
  return "[[gripper]]\nat = 0\nposition = [0, 0, 0]\n" + held + "\n";
}

inline const std::string level_clamp = gripper_text("direction = \"0 deg\"");
inline const std::string first_pin = gripper_text("hold = \"pin\"");

/// Steel wire of half a metre, without grippers.
inline const std::string steel_rod =
    "[rod]\nlength = \"50 cm\"\ndiameter = \"2 mm\"\nmaterial = \"spring_steel\"\n";

/// Returns the text with the first occurrence of a piece replaced. Throws std::runtime_error if the
/// text does not have the piece.
inline std::string replaced(std::string text, const std::string& piece, const std::string& other) {
  const std::size_t at = text.find(piece);
  if (at == std::string::npos) throw std::runtime_error("no " + piece + " in " + text);
  return text.replace(at, piece.size(), other);
}

/// Returns the message with which a scene's text is refused, or "no error".
inline std::string scene_error(const std::string& text) {
  return error_of<compare::InputError>([&] { return compare::parse_scene(text, "my.toml"); });
}

}  // namespace dlo::test
