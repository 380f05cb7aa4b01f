#include "comparison_text.hpp"

#include <cmath>

#include "output.hpp"

namespace dlo::cli {

std::string comparison_text(const compare::Comparison& c) {
  std::string out;
  const compare::Parameters& p = c.force.parameters;
  append(out, "{}   Gamma = {:.4g}\n", c.scene, c.gamma);
  append(out, "  force model     law {}, bookkeeping {}, N = {}, c_c = {:.6g} N",
         compare::to_string(c.settings.law), compare::to_string(c.settings.bookkeeping),
         c.settings.points, p.c_c);
  if (p.c_b > 0) append(out, ", c_b = {:.6g} N", p.c_b);
  append(out, "\n");
  const compare::Deviation& d = c.deviation;
  append(out, "  deviation       RMS {:.4g} mm = {:.4g} % of l", d.rms_m * 1e3,
         d.rms_over_length * 100);
  if (std::isfinite(d.rms_over_movement)) {
    append(out, " = {:.4g} % of the movement", d.rms_over_movement * 100);
  }
  append(out, "\n                  largest {:.4g} mm at s = {:.4f} m", d.max_m * 1e3, d.max_at_m);
  if (std::isfinite(d.tip_m)) append(out, ", tip {:.4g} mm", d.tip_m * 1e3);
  append(out, "\n");
  append(out, "                  tangent RMS {:.4g} deg, curvature RMS {:.4g} 1/m\n",
         d.angle_rms_rad * 57.29577951308232, d.curvature_rms_per_m);
  if (std::isfinite(c.undeformed_rms_over_length)) {
    append(out, "                  (the unbent rod would be {:.4g} % of l off)\n",
           c.undeformed_rms_over_length * 100);
  }
  append(out, "  E*/E            {:.4f}, where the RMS is {:.4g} mm ({} optimum)\n",
         c.effective_modulus.ratio, c.effective_modulus.rms_m * 1e3,
         compare::to_string(c.effective_modulus.optimum));
  const compare::Budget& b = c.budget;
  append(
      out,
      "  error budget    law {:.4g} mm, bookkeeping {:.4g} mm, discretisation {:.4g} mm, stretch "
      "{:.3g} mm, not at rest {:.2g} mm\n",
      b.law * 1e3, b.bookkeeping * 1e3, b.discretisation * 1e3, b.stretch * 1e3,
      b.not_at_rest * 1e3);
  append(out, "  cost            force {} steps, {:.3g} ms; energy {} evaluations, {:.3g} ms\n\n",
         c.force.steps, c.force.seconds * 1e3, c.energy_evaluations, c.energy_seconds * 1e3);
  return out;
}

}  // namespace dlo::cli
