// Cost of the parts of dlo::compare other than the models.
//
//     dlo_compare_benchmark --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
//
// sweep: scenes per second (items_per_second) over Gamma 0.1 to 100 and ten clamp angles, rows
// included, nothing written; threads:0 is all cores.

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>

#include "batch/sweep.hpp"

namespace {

using dlo::compare::Grid;
using dlo::compare::parse_axis;
using dlo::compare::SceneTemplate;
using dlo::compare::Sweep;
using dlo::compare::SweepModel;

constexpr const char* scene = R"(
rod = { length = "50 cm", diameter = "2 mm", material = "spring_steel" }
gripper = [{ at = 0, position = [0, 0, 0], direction = "0 deg" }]
)";

void sweep(benchmark::State& state, SweepModel model, const std::string& rows) {
  const Sweep swept(SceneTemplate(scene, "benchmark.toml"),
                    Grid({parse_axis("gripper.0.direction=lin:-80 deg:80 deg:10"),
                          parse_axis("gamma=log:0.1:100:" + rows)}),
                    model);
  std::int64_t bytes = 0;
  for (auto iteration : state) {
    (void)iteration;
    swept.run({0, swept.grid().size()}, static_cast<int>(state.range(0)), [&](const auto& cells) {
      bytes += static_cast<std::int64_t>(swept.line(cells).size());
    });
  }
  state.SetItemsProcessed(state.iterations() * swept.grid().size());
  state.SetBytesProcessed(bytes);
}

void on_all_cores(benchmark::internal::Benchmark* sweeps) {
  sweeps->ArgName("threads")->Arg(0)->UseRealTime()->Unit(benchmark::kMillisecond);
}

}  // namespace

BENCHMARK_CAPTURE(sweep, energy, SweepModel::energy, "200")->Arg(1)->Apply(on_all_cores);
BENCHMARK_CAPTURE(sweep, exact, SweepModel::exact, "20")->Apply(on_all_cores);
BENCHMARK_CAPTURE(sweep, chain, SweepModel::chain, "20")->Apply(on_all_cores);
BENCHMARK_CAPTURE(sweep, force, SweepModel::force, "2")->Apply(on_all_cores);

BENCHMARK_MAIN();
