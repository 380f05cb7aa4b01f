#include "picture.hpp"

namespace dlo::python {
namespace {

/// Tics that the figure asks for; None: those that the axes choose.
py::dict axis_dict(const compare::PlotAxis& laid_out, const compare::PlotAxis& described) {
  py::dict dict;
  dict["label"] = laid_out.label;
  dict["limits"] = py::make_tuple(*laid_out.from, *laid_out.to);
  dict["log"] = laid_out.logarithmic;
  dict["tics"] = py::none();
  if (described.tics) {
    py::list tics;
    for (const compare::Tic& tic : *described.tics) tics.append(py::make_tuple(tic.at, tic.label));
    dict["tics"] = tics;
  }
  return dict;
}

py::dict curve_dict(const compare::Curve& curve) {
  py::dict dict;
  dict["title"] = curve.title;
  dict["points"] = curve.z.empty() ? py::make_tuple(curve.x, curve.y)
                                   : py::make_tuple(curve.x, curve.y, curve.z);
  const compare::Look& look = curve.look;
  dict["colour"] = look.colour;
  dict["width"] = look.width;
  dict["dashes"] = static_cast<int>(look.dashes);
  dict["mark"] = static_cast<int>(look.mark);
  dict["mark_size"] = look.mark_size;
  dict["fill"] = look.fill;
  return dict;
}

}  // namespace

py::dict panel_dict(const compare::Panel& described) {
  const compare::Panel panel = compare::laid_out(described);
  py::list axes;
  axes.append(axis_dict(panel.x, described.x));
  axes.append(axis_dict(panel.y, described.y));
  if (panel.z) axes.append(axis_dict(*panel.z, *described.z));
  py::list curves;
  for (const compare::Curve& curve : panel.curves) curves.append(curve_dict(curve));
  py::list texts;
  for (const compare::Text& text : panel.texts) {
    texts.append(py::make_tuple(text.words, text.x, text.y, text.dx, text.dy));
  }
  py::dict dict;
  dict["size"] = py::make_tuple(compare::figure_width, panel.full_height());
  dict["upright"] = panel.upright;
  dict["equal"] = panel.equal_aspect;
  dict["axes"] = axes;
  dict["curves"] = curves;
  dict["texts"] = texts;
  return dict;
}

}  // namespace dlo::python
