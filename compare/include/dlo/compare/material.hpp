#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// What a rod is made of.
struct Material {
  std::string name;           ///< as scene files say it
  double youngs_modulus = 0;  ///< E [Pa]
  double density = 0;         ///< rho [kg/m^3]
  std::string source;         ///< where the numbers come from

  /// In every field.
  bool operator==(const Material&) const = default;
};

/// The materials of data/materials.toml, in the file's order; built into the library.
[[nodiscard]] const std::vector<Material>& materials();

/// Materials of a file of the user's own, of the same form.
/// @throws InputError
[[nodiscard]] std::vector<Material> read_materials(const std::string& text,
                                                   const std::string& file);
/// Reads such a file. @throws InputError as read_materials, or if it cannot be read
[[nodiscard]] std::vector<Material> load_materials(const std::string& path);

}  // namespace dlo::compare
