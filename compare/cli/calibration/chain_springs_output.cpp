#include "calibration/chain_springs_output.hpp"

#include <algorithm>

#include "base/display.hpp"
#include "base/quote.hpp"
#include "dlo/compare/material_fit.hpp"

namespace dlo::cli {
namespace {

using compare::append;
using compare::Json;

const char* text_of(compare::ChainClamp clamp) {
  switch (clamp) {
    case compare::ChainClamp::hinge:
      return "a hinge at the clamp";
    case compare::ChainClamp::welded:
      return "segments at clamps welded to them";
    case compare::ChainClamp::middle:
      break;
  }
  return "clamped in the middle of a segment";
}

std::string spring_range_text(double low, double high, const char* unit) {
  return low == high ? fmt::format("{:.4g}{}", low, unit)
                     : fmt::format("{:.4g} to {:.4g}{}", low, high, unit);
}

std::string lengths_text(const compare::ChainSprings& chain) {
  const std::vector<double>& h = chain.segment_lengths;
  if (h.empty()) return fmt::format("{:.4g} m", chain.segment_length);
  const auto [low, high] = std::minmax_element(h.begin(), h.end());
  return spring_range_text(*low, *high, " m");
}

std::string stiffness_text(const compare::ChainSprings& chain) {
  if (chain.joints.empty()) return fmt::format("{:.5g}", chain.stiffness);
  const auto [low, high] =
      std::minmax_element(chain.joints.begin(), chain.joints.end(),
                          [](const auto& a, const auto& b) { return a.stiffness < b.stiffness; });
  return spring_range_text(low->stiffness, high->stiffness, "");
}

/// Of unequal segments each joint.
std::string joints_text(const compare::ChainSprings& chain) {
  if (chain.joints.empty()) return "";
  std::string out = fmt::format("              {:>11} {:>15} {:>24}\n", "s [m]", "k [N m/rad]",
                                "discrete elastic rods'");
  for (const compare::ChainJoint& joint : chain.joints) {
    append(out, "              {:11.6f} {:15.6g} {:>24}\n", joint.at, joint.stiffness,
           joint.binormal_stiffness > 0 ? fmt::format("{:.6g}", joint.binormal_stiffness) : "-");
  }
  return out;
}

}  // namespace

std::string chains_text(const std::vector<compare::ChainSprings>& chains) {
  std::string out;
  for (std::size_t i = 0; i < chains.size(); ++i) {
    const compare::ChainSprings& chain = chains[i];
    append(out, "{:<11} {} segments of {}, {}: {} N m/rad a joint, {:.4g} times EI/h{}\n",
           i == 0 ? "chain" : "", chain.segments, lengths_text(chain), text_of(chain.clamp),
           stiffness_text(chain), chain.over_rod,
           chain.joints.empty() ? "" : ", h the mean of its two segments");
    append(out, "            ({:.4g} mm from the rod on {}, RMS)\n", chain.rms_m * 1e3,
           compare::display(chain.scene));
    if (chain.joints.empty() && chain.binormal_stiffness > 0) {
      append(out, "            ({:.5g} N m/rad a joint of discrete elastic rods)\n",
             chain.binormal_stiffness);
    }
    out += joints_text(chain);
  }
  return out;
}

Json chains_json(const std::vector<compare::ChainSprings>& chains) {
  Json result = Json::array();
  for (const compare::ChainSprings& chain : chains) {
    result.push_back({{"scene", chain.scene},
                      {"clamp", compare::to_string(chain.clamp)},
                      {"segments", chain.segments},
                      {"segment_length_m", chain.segment_length},
                      {"joint_stiffness_Nm_per_rad", chain.stiffness},
                      {"binormal_stiffness_Nm_per_rad", chain.binormal_stiffness},
                      {"over_bending_stiffness_per_length", chain.over_rod},
                      {"rms_m", chain.rms_m}});
    if (!chain.joints.empty()) {
      result.back()["segment_lengths_m"] = chain.segment_lengths;
      result.back()["joints"] =
          compare::json_list(chain.joints, [](const compare::ChainJoint& joint) -> Json {
            return {{"at_m", joint.at},
                    {"joint_stiffness_Nm_per_rad", joint.stiffness},
                    {"binormal_stiffness_Nm_per_rad", joint.binormal_stiffness}};
          });
    }
  }
  return result;
}

}  // namespace dlo::cli
