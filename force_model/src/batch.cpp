#include "dlo/force_model/batch.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>
#include <utility>

#include "lockstep.hpp"
#include "require.hpp"

namespace dlo::force_model {
namespace {

/// Throws unless all rods can share one kernel.
void require_common_kernel(const std::vector<BatchRod>& rods) {
  require(!rods.empty(), "Batch", "number of rods", 0, ">= 1");
  const BatchRod& first = rods.front();
  const auto require_same = [](bool same, std::string_view what, std::size_t index) {
    require(same, "Batch", what, static_cast<double>(index),
            "the index of a rod that agrees with the first rod in this");
  };
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const BatchRod& rod = rods[i];
    const StepPolicy& policy = rod.options.policy;
    require_same(rod.rod.points() == first.rod.points(),
                 "index of a rod with a different number of points", i);
    require_same(rod.rod.bending.law == first.rod.bending.law,
                 "index of a rod with a different bending law", i);
    require_same(rod.rod.bending.natural_turns.size() == first.rod.bending.natural_turns.size(),
                 "index of a rod with a different number of natural turns", i);
    require_same(policy == first.options.policy, "index of a rod with a different step policy", i);
    require_same(rod.options.instruction_set == first.options.instruction_set,
                 "index of a rod with a different instruction set", i);
  }
}

}  // namespace

Batch::Batch(const std::vector<BatchRod>& rods) : size_(rods.size()) {
  require_common_kernel(rods);
  const std::span<const BatchRod> all = rods;
  blocks_.reserve((size_ + rods_per_block - 1) / rods_per_block);
  for (std::size_t first = 0; first < size_; first += rods_per_block) {
    blocks_.emplace_back(all.subspan(first, std::min(rods_per_block, size_ - first)), true);
  }
}

Batch::Batch(Batch&& other) noexcept = default;
Batch& Batch::operator=(Batch&& other) noexcept = default;
Batch::~Batch() = default;

std::size_t Batch::blocks() const { return blocks_.size(); }

void Batch::step_block(std::size_t block, long count) {
  BatchBlock& lockstep = blocks_.at(block);
  std::array<StepResult, rods_per_block> results;
  for (long i = 0; i < count && lockstep.any_active(); ++i) {
    lockstep.step(results);
    for (std::size_t rod = 0; rod < lockstep.size(); ++rod) {
      const bool diverged = results[rod].status == StepStatus::diverged;
      if (diverged && lockstep.active(rod)) lockstep.set_active(rod, false);
    }
  }
}

void Batch::step(long count) {
  for (std::size_t block = 0; block < blocks_.size(); ++block) step_block(block, count);
}

std::vector<RelaxResult> Batch::relax_block(std::size_t block, const RelaxOptions& options) {
  BatchBlock& lockstep = blocks_.at(block);
  std::vector<RelaxResult> results = lockstep.relax(options);
  for (std::size_t rod = 0; rod < lockstep.size(); ++rod) {
    if (results[rod].status == RelaxStatus::diverged) lockstep.set_active(rod, false);
  }
  return results;
}

std::vector<RelaxResult> Batch::relax(const RelaxOptions& options) {
  std::vector<RelaxResult> results;
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    for (RelaxResult& result : relax_block(block, options)) results.push_back(std::move(result));
  }
  return results;
}

void Batch::move_grip(std::size_t rod, std::size_t grip,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& targets,
                      const Eigen::Vector3d& reference) {
  require(rod < size_, "Batch::move_grip", "rod", static_cast<double>(rod),
          "smaller than the number of rods");
  blocks_[rod / rods_per_block].move_grip(rod % rods_per_block, grip, targets, reference);
}

const BatchBlock& Batch::block_of(std::size_t index) const {
  require(index < size_, "Batch", "rod", static_cast<double>(index),
          "smaller than the number of rods");
  return blocks_[index / rods_per_block];
}

const Rod& Batch::rod(std::size_t index) const {
  return block_of(index).rod(index % rods_per_block);
}

Eigen::Matrix3Xd Batch::points(std::size_t index) const {
  return block_of(index).points(index % rods_per_block);
}

bool Batch::diverged(std::size_t index) const {
  return !block_of(index).active(index % rods_per_block);
}

const StepOptions& Batch::options(std::size_t index) const {
  return block_of(index).control(index % rods_per_block).options();
}

long Batch::steps(std::size_t index) const {
  return block_of(index).control(index % rods_per_block).steps();
}

}  // namespace dlo::force_model
