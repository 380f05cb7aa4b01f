#include "picture.hpp"

namespace dlo::python {
namespace {

/// Tics that the figure asks for; None: those that the axes choose.
py::dict axis_dict(const compare::PlotAxis& laid_out, const compare::PlotAxis& described) {
  py::object tics = py::none();
  if (described.tics) {
    py::list list;
    for (const compare::Tic& tic : *described.tics) list.append(py::make_tuple(tic.at, tic.label));
    tics = list;
  }
  py::dict result;
  result["label"] = laid_out.label;
  result["limits"] = py::make_tuple(*laid_out.from, *laid_out.to);
  result["log"] = laid_out.logarithmic;
  result["tics"] = tics;
  return result;
}

py::dict curve_dict(const compare::PlottedCurve& curve) {
  const compare::Look& look = curve.look;
  py::dict result;
  result["title"] = curve.title;
  result["points"] = curve.z.empty() ? py::make_tuple(curve.x, curve.y)
                                     : py::make_tuple(curve.x, curve.y, curve.z);
  result["colour"] = look.colour;
  result["width"] = look.width;
  result["dashes"] = static_cast<int>(look.dashes);
  result["mark"] = static_cast<int>(look.mark);
  result["mark_size"] = look.mark_size;
  result["fill"] = look.fill;
  return result;
}

}  // namespace

py::dict panel_dict(const compare::Panel& described) {
  const compare::Panel panel = compare::laid_out(described);
  py::list axes;
  axes.append(axis_dict(panel.x, described.x));
  axes.append(axis_dict(panel.y, described.y));
  if (panel.z) axes.append(axis_dict(*panel.z, *described.z));
  py::list curves;
  for (const compare::PlottedCurve& curve : panel.curves) curves.append(curve_dict(curve));
  py::list texts;
  for (const compare::Text& text : panel.texts) {
    texts.append(py::make_tuple(text.words, text.x, text.y, text.dx, text.dy));
  }
  py::dict result;
  result["size"] = py::make_tuple(compare::figure_width, panel.full_height());
  result["upright"] = panel.upright;
  result["equal"] = panel.equal_aspect;
  result["axes"] = axes;
  result["curves"] = curves;
  result["texts"] = texts;
  return result;
}

}  // namespace dlo::python
