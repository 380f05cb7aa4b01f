#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "batch/sweep_grid.hpp"
#include "dlo/compare/choice.hpp"
#include "dlo/compare/solution.hpp"
#include "reading/scene_template.hpp"
#include "record/solution_fields.hpp"

namespace dlo::compare {

/// What is computed for every scene of a sweep.
enum class SweepModel {
  energy,
  chain,
  exact,
  force,
  compare,        ///< the force model, stepped to rest, against the energy model
  compare_chain,  ///< the chain, which is the force model's rest shape without steps
};

/// As --model spells them.
template <>
struct Choices<SweepModel> {
  /// In the enumeration's order.
  static constexpr Choice<SweepModel> all[] = {
      {SweepModel::energy, "energy", ""},
      {SweepModel::chain, "chain", ""},
      {SweepModel::exact, "exact", ""},
      {SweepModel::force, "force", ""},
      {SweepModel::compare, "compare", "force against energy"},
      {SweepModel::compare_chain, "compare-chain",
       "its rest shape, without steps, against energy"}};
};

/// What all cells of a column are, where there are any.
enum class CellKind { whole, number, text };

/// A column of a sweep's table.
struct SweepColumn {
  std::string name;  ///< in the header
  CellKind kind = CellKind::number;
};

/// A cell: nothing where a row has no result. A count is whole, in a column of numbers too.
using SweepCell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// Rows first, first + step, ... below last.
struct RowRange {
  std::int64_t first = 0;  ///< the first row, from 0
  std::int64_t last = 0;   ///< one past the last row
  std::int64_t step = 1;   ///< > 0
};

/// A scene, a grid over its fields, and what to compute. Every row of the table that it describes
/// depends on its number only, never on other rows, threads or times.
class Sweep {
 public:
  /// @throws InputError if no scene can be read: of every grid of up to 1000 rows all are tried, of
  /// a larger one 1000 that are spread over it
  Sweep(SceneTemplate scene, Grid grid, SweepModel model, const SolveOptions& options = {});

  /// Over the scene's fields.
  [[nodiscard]] const Grid& grid() const { return grid_; }

  /// row, one column for each varied field (of numbers if all its values are), the results, status.
  ///
  /// All models: gamma (unless it is varied), tip_x_m, tip_y_m, tip_z_m (the rod's end at s = l),
  /// energy_J, evaluations (force, compare: steps). energy, exact: terms. compare and
  /// compare-chain, of the force model or the chain against the energy model: rms_over_length,
  /// max_over_length, tip_over_length (empty without a free end), effective_modulus_ratio,
  /// rms_at_effective_modulus_over_length, optimum, energy_evaluations. Then shape_numbers().
  [[nodiscard]] std::vector<SweepColumn> columns() const;
  /// Their names, as a CSV line.
  [[nodiscard]] std::string header() const;

  /// The scene of a row. @throws InputError if the grid's values make none
  [[nodiscard]] Scene scene(std::int64_t row) const;

  /// One row as a CSV line. status is "ok", or why there are no results: a scene that is refused or
  /// does not converge is a row like any other. Numbers have 10 significant digits.
  [[nodiscard]] std::string row(std::int64_t row) const;
  /// The same with all digits, a cell for each column.
  [[nodiscard]] std::vector<SweepCell> cells(std::int64_t row) const;

  /// Computes rows on several threads and hands their lines over in order. No more than a fixed
  /// number of rows per thread is kept at any time.
  /// @param threads  0: all cores; more than there are cores only cost memory
  /// @param take     called by one thread at a time; its exceptions end the run and come out of it
  void run(RowRange rows, int threads,
           const std::function<void(const std::string& line)>& take) const;
  /// The same with cells().
  void run_cells(RowRange rows, int threads,
                 const std::function<void(const std::vector<SweepCell>& cells)>& take) const;

 private:
  [[nodiscard]] std::vector<SweepColumn> result_columns() const;
  /// Of the columns behind the varied fields.
  [[nodiscard]] std::vector<SweepCell> results(std::int64_t row) const;
  [[nodiscard]] std::vector<SweepCell> solved(const Scene& scene) const;
  void compare_to_energy(const Scene& scene, const Solution& solution,
                         std::vector<SweepCell>& cells) const;
  [[nodiscard]] std::vector<SweepCell> without_results(const std::string& status) const;
  void require_one_scene();

  SceneTemplate scene_;
  Grid grid_;
  SweepModel model_;
  SolveOptions options_;
  std::vector<Field<SolvedShape>> numbers_;  // of a shape, those of such scenes
  bool gamma_varied_ = false;
  std::vector<CellKind> kinds_;  // of the varied fields
};

}  // namespace dlo::compare
