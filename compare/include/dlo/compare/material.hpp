#pragma once

#include <string>
#include <vector>

namespace dlo::compare {

/// Material of a rod.
struct Material {
  std::string name;           ///< name in scene files
  double youngs_modulus = 0;  ///< E [Pa]
  double density = 0;         ///< rho [kg/m^3]
  std::string source;         ///< source of the numbers

  /// Compares all fields.
  bool operator==(const Material&) const = default;
};

/// Returns the materials of data/materials.toml, in the file's order; they are built into the
/// library.
[[nodiscard]] const std::vector<Material>& materials();

/// Reads materials from a user's text in the form of data/materials.toml.
/// @throws InputError
[[nodiscard]] std::vector<Material> read_materials(const std::string& text,
                                                   const std::string& file);
/// Reads a file of materials. @throws InputError as read_materials, or if it cannot be read
[[nodiscard]] std::vector<Material> load_materials(const std::string& path);

/// A layer of a cable about the cable's axis: a tube around the inner layers, or straight strands
/// that lie side by side on them.
struct Layer {
  double youngs_modulus = 0;   ///< E [Pa]
  double density = 0;          ///< rho [kg/m^3]
  double outer_diameter = 0;   ///< outer diameter of a tube [m]; 0: strands
  int strands = 0;             ///< number of strands, 3 or more, or one on the axis; 0: a tube
  double strand_diameter = 0;  ///< diameter of each strand, solid and round [m]
};

/// Stiffnesses and mass of a rod of layers. Bonded layers: plane sections stay plane. Layers free
/// to slip: every strand bends and twists about its own axis; coaxial tubes have the same stiffness
/// in both cases.
struct LayeredSection {
  double bonded_bending_stiffness = 0;    ///< EI [N m^2]
  double free_bending_stiffness = 0;      ///< EI [N m^2], <= the bonded one
  double bonded_torsional_stiffness = 0;  ///< GJ [N m^2], Poisson's ratio assumed_poisson_ratio
  double free_torsional_stiffness = 0;    ///< GJ [N m^2], with the same ratio
  double axial_stiffness = 0;             ///< EA [N]
  double mass_per_length = 0;             ///< rho A [kg/m]
  double outer_diameter = 0;              ///< [m]
  bool bonded = true;  ///< whether a scene uses the bonded stiffnesses, else the free ones

  /// Compares all fields.
  bool operator==(const LayeredSection&) const = default;
};

/// Computes the stiffnesses and mass of a rod from its layers.
/// @param layers  from the inside out; of strands, strand_diameter > 0 is not checked
/// @throws InputError if a tube is not outside of the previous layer, strands do not fit side by
/// side, or there are two strands, fewer than none, or one that is not the first layer
[[nodiscard]] LayeredSection layered_section(const std::vector<Layer>& layers);

}  // namespace dlo::compare
