#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dlo/compare/deviation.hpp"
#include "dlo/compare/scene.hpp"
#include "dlo/compare/solution.hpp"

namespace dlo::compare {

/// How far a shape is from the energy model's, each as a share of the rod's length [-].
struct ShapeErrors {
  double rms = 0;             ///< along the rod
  std::optional<double> max;  ///< of any point; nothing from dlo suite, which measures rms alone
  std::optional<double> tip;  ///< nothing if both ends are held
};

/// Errors of one scene with one choice of model, law, bookkeeping and N, or of one program and N.
struct BaselineCase {
  std::string scene;                                  ///< its name
  std::string program;                                ///< name of somebody else's, or empty
  Model model = Model::force;                         ///< force or chain, without a program
  BendingLaw law = BendingLaw::hooke;                 ///< of bending
  Bookkeeping bookkeeping = Bookkeeping::consistent;  ///< of the polygon
  int points = 0;                                     ///< N
  ShapeErrors errors;                                 ///< those of this case
  /// 16 hexadecimal digits that stand for the rest of the scene; empty: not known.
  std::string fingerprint;

  /// "copper wire (force, law hooke, bookkeeping consistent, N = 16)": two cases with the same name
  /// are the same case.
  [[nodiscard]] std::string name() const;
  /// "force", or the name of the program.
  [[nodiscard]] std::string solver() const;
};

/// Reads a baseline: TOML with schema = "dlo/baseline/1" and a [[case]] for each.
/// @throws InputError naming file, line, key, value and what is allowed, also if a case comes twice
[[nodiscard]] std::vector<BaselineCase> read_baseline(const std::string& text,
                                                      const std::string& file);
/// Reads a baseline file. @throws InputError as read_baseline, or if it cannot be read
[[nodiscard]] std::vector<BaselineCase> load_baseline(const std::string& path);

/// The same of a file that may not be there yet: no cases.
[[nodiscard]] std::vector<BaselineCase> present_baseline(const std::string& path);

/// Replaces a baseline file that is still as it was read.
/// @throws OutputError if another process has changed it, or it cannot be written
void replace_baseline(const std::string& path, const std::vector<BaselineCase>& read,
                      const std::vector<BaselineCase>& cases);

/// A baseline's text, sorted by name, errors with 6 significant digits: what does not change reads
/// the same.
[[nodiscard]] std::string baseline_text(std::vector<BaselineCase> cases);

}  // namespace dlo::compare
