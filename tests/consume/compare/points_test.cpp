// Example of doc/tutorial/ci.md: judges an array of points, with a scene that is made in code.

// [page]
#include <dlo/compare.hpp>
#include <dlo/compare/gtest.hpp>
using namespace dlo::compare;

TEST(MySimulator, HoldsTheWireRight) {
  const Scene wire = make_scene({{"rod.length", "30 cm"},
                                 {"rod.diameter", "0.5 mm"},
                                 {"rod.material", "copper"},
                                 {"gripper.0.at", 0},
                                 {"gripper.0.position", {0, 0, 0}},
                                 {"gripper.0.direction", "30 deg"}});
  const double points[6][3] = {{0, 0, 0},           {0.0534, 0.0272, 0}, {0.1089, 0.0502, 0},
                               {0.1653, 0.0707, 0}, {0.2221, 0.09, 0},   {0.279, 0.109, 0}};
  const Eigen::Map<const Eigen::Matrix3Xd> mine(*points, 3, 6);
  EXPECT_SHAPE_NEAR((Shape{equal_arc_lengths(wire.length, 6), mine}), wire, 0.01);
}
// [end of page]
