#include "picture.hpp"

namespace dlo::python {
namespace {

using namespace py::literals;

/// Tics that the figure asks for; None: those that the axes choose.
py::dict axis_dict(const compare::PlotAxis& laid_out, const compare::PlotAxis& described) {
  py::object tics = py::none();
  if (described.tics) {
    py::list list;
    for (const compare::Tic& tic : *described.tics) list.append(py::make_tuple(tic.at, tic.label));
    tics = list;
  }
  return py::dict("label"_a = laid_out.label,
                  "limits"_a = py::make_tuple(*laid_out.from, *laid_out.to),
                  "log"_a = laid_out.logarithmic, "tics"_a = tics);
}

py::dict curve_dict(const compare::PlottedCurve& curve) {
  const compare::Look& look = curve.look;
  return py::dict(
      "title"_a = curve.title,
      "points"_a = curve.z.empty() ? py::make_tuple(curve.x, curve.y)
                                   : py::make_tuple(curve.x, curve.y, curve.z),
      "colour"_a = look.colour, "width"_a = look.width, "dashes"_a = static_cast<int>(look.dashes),
      "mark"_a = static_cast<int>(look.mark), "mark_size"_a = look.mark_size, "fill"_a = look.fill);
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
  return py::dict("size"_a = py::make_tuple(compare::figure_width, panel.full_height()),
                  "upright"_a = panel.upright, "equal"_a = panel.equal_aspect, "axes"_a = axes,
                  "curves"_a = curves, "texts"_a = texts);
}

}  // namespace dlo::python
