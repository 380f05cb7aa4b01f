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

/// A layer of a cable about the cable's axis: a tube around what is within it, or straight strands
/// that lie side by side on that.
struct Layer {
  double youngs_modulus = 0;   ///< E [Pa]
  double density = 0;          ///< rho [kg/m^3]
  double outer_diameter = 0;   ///< of a tube [m]; 0: strands
  int strands = 0;             ///< how many, 3 or more, or one on the axis; 0: a tube
  double strand_diameter = 0;  ///< of each, solid and round [m]
};

/// What a rod has of its layers. Bonded, plane sections stay plane. Free to slip, every strand
/// bends and twists about its own axis; tubes about one axis have the same stiffness in both.
struct LayeredSection {
  double bonded_bending_stiffness = 0;    ///< EI [N m^2]
  double free_bending_stiffness = 0;      ///< EI [N m^2], <= the bonded one
  double bonded_torsional_stiffness = 0;  ///< GJ [N m^2], Poisson's ratio assumed_poisson_ratio
  double free_torsional_stiffness = 0;    ///< GJ [N m^2], likewise
  double axial_stiffness = 0;             ///< EA [N]
  double mass_per_length = 0;             ///< rho A [kg/m]
  double outer_diameter = 0;              ///< [m]
  bool bonded = true;                     ///< which of the two bounds a scene takes

  /// In every field.
  bool operator==(const LayeredSection&) const = default;
};

/// @param layers  from the inside out
/// @throws InputError if one is not outside of the one before, or its strands do not fit side by
/// side
[[nodiscard]] LayeredSection layered_section(const std::vector<Layer>& layers);

}  // namespace dlo::compare
