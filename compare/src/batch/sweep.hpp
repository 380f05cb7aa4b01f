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

/// Model, or comparison of two models, that a sweep computes for every scene.
enum class SweepModel {
  energy,
  chain,
  exact,
  force,
  compare,  ///< the force model, stepped to rest, compared with the energy model
  /// Comparison of the chain, which is the force model's equilibrium without time steps.
  compare_chain,
};

/// Names of the models for --model.
template <>
struct Choices<SweepModel> {
  /// All models, in the order of the enumeration.
  static constexpr Choice<SweepModel> all[] = {
      {SweepModel::energy, "energy", ""},
      {SweepModel::chain, "chain", ""},
      {SweepModel::exact, "exact", ""},
      {SweepModel::force, "force", ""},
      {SweepModel::compare, "compare", "force against energy"},
      {SweepModel::compare_chain, "compare-chain",
       "its rest shape, without steps, against energy"}};
};

/// Type of all cells of a column that are not empty.
enum class CellKind { whole, number, text };

struct SweepColumn {
  std::string name;  ///< name in the header
  CellKind kind = CellKind::number;
};

/// Cell of a row: empty if the row has no result, NaN if it has results but not this number (both
/// are empty in the CSV line). Counts are integers, also in a column of numbers.
using SweepCell = std::variant<std::monostate, std::int64_t, double, std::string>;

/// Rows first, first + step, ..., below last.
struct RowRange {
  std::int64_t first = 0;  ///< the first row, from 0
  std::int64_t last = 0;   ///< upper bound of the rows, not included
  std::int64_t step = 1;   ///< > 0
};

/// Scene template, grid over its fields, and model to compute. A row of the resulting table depends
/// on its row number only, never on other rows, threads or times.
class Sweep {
 public:
  /// Creates a sweep and checks that the grid gives readable scenes.
  /// @throws InputError if no row gives a readable scene. All rows of a grid of up to 1000 rows are
  /// tried, of a larger grid 1000 rows that are spread over it
  Sweep(SceneTemplate scene, Grid grid, SweepModel model, const SolveOptions& options = {});

  [[nodiscard]] const Grid& grid() const { return grid_; }

  /// Returns the columns: row, one column for each varied field (of numbers if all its values are
  /// numbers), the results, status.
  ///
  /// All models: gamma (unless it is varied), tip_x_m, tip_y_m, tip_z_m (the rod's end at s = l),
  /// energy_J, evaluations (force, compare: steps). energy, exact: terms. compare and
  /// compare-chain, of the force model or the chain against the energy model: rms_over_length,
  /// max_over_length, tip_over_length (empty without a free end), effective_modulus_ratio,
  /// rms_at_effective_modulus_over_length, optimum, energy_evaluations. Then shape_numbers().
  [[nodiscard]] std::vector<SweepColumn> columns() const;
  /// Returns the names of columns() as a CSV line.
  [[nodiscard]] std::string header() const;

  /// Returns the scene of a row. @throws InputError if the grid's values give no valid scene
  [[nodiscard]] Scene scene(std::int64_t row) const;

  /// Computes one row at full precision, one cell per column. status is "ok", or the reason why
  /// there are no results: a scene that is refused or does not converge gives a row like any other.
  /// @throws std::bad_alloc, std::system_error without memory or threads
  [[nodiscard]] std::vector<SweepCell> cells(std::int64_t row) const;
  /// Returns the cells of a row as a CSV line. Numbers of results have 10 significant digits.
  [[nodiscard]] std::string line(const std::vector<SweepCell>& cells) const;

  /// Computes rows on several threads and passes their cells() to `take` in order. At most a fixed
  /// number of rows per thread is stored at any time.
  /// @param threads  0: all cores; more threads than cores only cost memory
  /// @param take     called by one thread at a time; its exceptions end the run and are rethrown
  void run(RowRange rows, int threads,
           const std::function<void(const std::vector<SweepCell>& cells)>& take) const;

 private:
  [[nodiscard]] std::vector<SweepColumn> result_columns() const;
  /// Computes the cells of result_columns().
  [[nodiscard]] std::vector<SweepCell> results(std::int64_t row) const;
  [[nodiscard]] std::vector<SweepCell> solved(const Scene& scene) const;
  void compare_to_energy(const Scene& scene, const Solution& solution,
                         std::vector<SweepCell>& cells) const;
  [[nodiscard]] std::vector<SweepCell> cells_with_status(const std::string& status) const;
  void require_one_scene();

  SceneTemplate scene_;
  Grid grid_;
  SweepModel model_;
  SolveOptions options_;
  std::vector<Field<SolvedShape>> numbers_;  // shape_numbers() of the sweep's scenes
  bool gamma_varied_ = false;
  std::vector<CellKind> kinds_;  // types of the varied fields' columns
};

}  // namespace dlo::compare
