// What the module's calls cost in C++, for cost.py: dlo_python_cost SCENE prints microseconds of
// one check of 16 points, and seconds of a million steps in blocks of 30.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "dlo/compare/discretise.hpp"
#include "dlo/compare/scene_file.hpp"
#include "dlo/compare/shape_check.hpp"
#include "dlo/compare/solve.hpp"
#include "dlo/force_model/simulation.hpp"
#include "polygon/point_layout.hpp"

namespace {

using namespace dlo;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> times) {
  std::nth_element(times.begin(), times.begin() + static_cast<long>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

double check_time(const compare::Scene& scene) {
  const compare::Solution solution = compare::solve(scene, compare::Model::exact, {},
                                                    compare::equal_arc_lengths(scene.length, 16));
  const compare::MeasuredShape shape{
      .file = "points", .points = solution.shape.points, .arc_length = {}};
  std::vector<double> times;
  for (int i = 0; i < 200; ++i) {
    const double begin = now();
    const compare::ShapeCheck check = compare::check_shape(scene, shape);
    times.push_back(now() - begin);
  }
  return median(times);
}

double loop_time(const compare::Scene& scene) {
  const compare::Discretisation discretisation = compare::discretise(scene, scene.force_model);
  force_model::Simulation simulation(discretisation.rod, discretisation.starts.front(),
                                     compare::step_options(scene.force_model, discretisation));
  constexpr int blocks = 33'334;
  const double begin = now();
  for (int block = 0; block < blocks; ++block) {
    for (int i = 0; i < 30; ++i) {
      if (simulation.step().status == force_model::StepStatus::diverged) return 0;
    }
  }
  return now() - begin;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    const compare::Scene scene = compare::load_scene(argv[1]);
    std::printf("%.3f %.6f\n", 1e6 * check_time(scene), loop_time(scene));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
