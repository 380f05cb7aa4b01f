#include "picture.hpp"

namespace dlo::python {

py::list view_list(const std::vector<compare::View>& views) {
  py::list list;
  for (const compare::View& view : views) list.append(py::make_tuple(view.right, view.up));
  return list;
}

}  // namespace dlo::python
