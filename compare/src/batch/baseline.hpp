#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// Distances of a shape from the energy model's, divided by the rod's length [-].
struct ShapeErrors {
  double rms = 0;  ///< root mean square along the rod
  /// Largest distance of any point; empty from dlo suite, which measures rms alone
  std::optional<double> max;
  /// Distance of the free end, of that at s = l if both are free; empty if both ends are held, and
  /// from dlo suite
  std::optional<double> tip;
};

/// Errors of one scene with one choice of model, law, bookkeeping and N, or with one foreign
/// program and N.
struct BaselineCase {
  std::string scene;           ///< name of the scene
  std::string program;         ///< name of the foreign program; empty if `model` was measured
  Model model = Model::force;  ///< force or chain; not used if `program` is set
  BendingLaw law = BendingLaw::hooke;                 ///< joint law
  Bookkeeping bookkeeping = Bookkeeping::consistent;  ///< end and mass convention of the polygon
  int points = 0;                                     ///< number of points N
  ShapeErrors errors;                                 ///< errors of the shape of this case
  /// Hash of the scene data that the name does not contain, 16 hexadecimal digits; empty if
  /// unknown.
  std::string fingerprint;

  /// Returns a name such as "copper wire (force, law hooke, bookkeeping consistent, N = 16)". Two
  /// cases with equal names are the same case.
  [[nodiscard]] std::string name() const;
  /// Returns the model, such as "force", or the name of the foreign program.
  [[nodiscard]] std::string solver() const;
};

/// Reads a baseline: TOML with schema = "dlo/baseline/1" and one [[case]] per case.
/// @throws InputError with file, line, key, value and what is allowed, also if a case occurs twice
[[nodiscard]] std::vector<BaselineCase> read_baseline(const std::string& text,
                                                      const std::string& file);
/// Reads a baseline file. @throws InputError as read_baseline, or if the file cannot be read
[[nodiscard]] std::vector<BaselineCase> load_baseline(const std::string& path);

/// Reads a baseline file as load_baseline does, or returns no cases if the file does not exist.
[[nodiscard]] std::vector<BaselineCase> load_baseline_if_exists(const std::string& path);

/// Replaces a baseline file if its content is still `read`.
/// @throws OutputError if another process has changed the file; else as load_baseline() and
/// write_file()
void replace_baseline(const std::string& path, const std::vector<BaselineCase>& read,
                      const std::vector<BaselineCase>& cases);

/// Returns the text of a baseline: cases sorted by name, errors with 6 significant digits.
/// Unchanged cases therefore give unchanged text.
[[nodiscard]] std::string baseline_text(std::vector<BaselineCase> cases);

}  // namespace dlo::compare
