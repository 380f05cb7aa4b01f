// A scene as Simbody solves it, for dlo bench and dlo regress (compare/doc/protocol.md).
//
//     simbody SCENE SHAPE
//
// SCENE is what `dlo scene --format json` writes, SHAPE becomes a CSV file of the rod's axis. The
// rod is a chain of ball joints; a second clamp is a Constraint::Weld of the last segment. The
// shape at rest is the minimum of the potential energy, which Simbody's LocalEnergyMinimizer finds
// without steps of time.

#include <Simbody.h>

#include <cstddef>
#include <vector>

#include "chain.hpp"

namespace {

using foreign::Chain;
using foreign::Quaternion;
using SimTK::MobilizedBody;
using SimTK::Real;
using SimTK::State;
using SimTK::Vec3;

Vec3 to_simbody(const foreign::Vector& v) { return {v[0], v[1], v[2]}; }
SimTK::Rotation to_simbody(const Quaternion& q) {
  return SimTK::Rotation(SimTK::Quaternion(q[0], q[1], q[2], q[3]));
}

/// Hinges and forces on points. Body i begins at the point i + 1 and ends at the next.
class Forces : public SimTK::Force::Custom::Implementation {
 public:
  Forces(const Chain& chain, const std::vector<MobilizedBody>& bodies)
      : chain_(chain), bodies_(bodies) {}

  void calcForce(const State& state, SimTK::Vector_<SimTK::SpatialVec>& on_bodies,
                 SimTK::Vector_<Vec3>& /*on_particles*/,
                 SimTK::Vector& /*on_mobilities*/) const override {
    for (std::size_t i = 0; i < chain_.hinges.size(); ++i) {
      const MobilizedBody& body = bodies_[i];
      const Vec3 torque = body.getBodyRotation(state) *
                          to_simbody(foreign::torque(chain_.hinges[i], turn(state, i)));
      body.applyBodyTorque(state, torque, on_bodies);
      body.getParentMobilizedBody().applyBodyTorque(state, -torque, on_bodies);
      body.applyForceToBodyPoint(state, Vec3(chain_.segment[i + 1], 0, 0),
                                 to_simbody(chain_.force[i + 2]), on_bodies);
    }
  }

  [[nodiscard]] Real calcPotentialEnergy(const State& state) const override {
    Real sum = 0;
    for (std::size_t i = 0; i < chain_.hinges.size(); ++i) {
      const Vec3 end =
          bodies_[i].findStationLocationInGround(state, Vec3(chain_.segment[i + 1], 0, 0));
      sum += foreign::energy(chain_.hinges[i], turn(state, i)) -
             SimTK::dot(to_simbody(chain_.force[i + 2]), end);
    }
    return sum;
  }

  [[nodiscard]] bool dependsOnlyOnPositions() const override { return true; }

 private:
  [[nodiscard]] Quaternion turn(const State& state, std::size_t i) const {
    const SimTK::Quaternion q =
        bodies_[i].getMobilizerTransform(state).R().convertRotationToQuaternion();
    return {q[0], q[1], q[2], q[3]};
  }

  const Chain& chain_;
  const std::vector<MobilizedBody>& bodies_;
};

/// Minimises the energy to the smallest tolerance of its gradient [N m] of 1e-9, 1e-8 and 1e-7 that
/// rounding allows; the minimiser throws if a tolerance is too small.
/// @throws SimTK::Exception::OptimizerFailed if all are
State at_rest(const SimTK::MultibodySystem& system, const State& start) {
  for (Real tolerance = 1e-9;; tolerance *= 10) {
    State state = start;
    try {
      SimTK::LocalEnergyMinimizer::minimizeEnergy(system, state, tolerance);
      return state;
    } catch (const SimTK::Exception::OptimizerFailed&) {
      if (tolerance > 1e-8) throw;
    }
  }
}

/// Returns the positions of the hinges and of the tip at rest, beginning with the first hinge.
std::vector<foreign::Vector> solve(const Chain& chain) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  const SimTK::Body::Rigid segment(
      SimTK::MassProperties(1, Vec3(0), SimTK::Inertia(1, 1, 1)));  // no effect at rest
  std::vector<MobilizedBody> bodies;
  for (std::size_t i = 0; i < chain.hinges.size(); ++i) {
    const SimTK::Transform place =
        i == 0 ? SimTK::Transform(to_simbody(chain.frames[0]), to_simbody(chain.first_point))
               : SimTK::Transform(Vec3(chain.segment[i], 0, 0));
    MobilizedBody parent = i == 0 ? matter.updGround() : bodies.back();
    bodies.push_back(MobilizedBody::Ball(parent, place, segment, SimTK::Transform()));
  }
  const SimTK::Force::Custom custom(forces, new Forces(chain, bodies));  // owns the object
  if (chain.second_clamp) {
    const SimTK::Transform end(to_simbody(chain.frames.back()), to_simbody(chain.last_hinge));
    const SimTK::Constraint::Weld weld(matter.updGround(), end, bodies.back(), SimTK::Transform());
  }
  system.realizeTopology();
  State state = system.getDefaultState();
  system.realizeModel(state);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].setQToFitRotation(state, to_simbody(chain.turn(i)));
  }
  if (chain.second_clamp) SimTK::Assembler(system).assemble(state);
  state = at_rest(system, state);
  system.realize(state, SimTK::Stage::Position);
  std::vector<foreign::Vector> points = {chain.first_point};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 end = bodies[i].findStationLocationInGround(state, Vec3(chain.segment[i + 1], 0, 0));
    points.push_back({end[0], end[1], end[2]});
  }
  return points;
}

}  // namespace

int main(int argc, char** argv) { return foreign::run("simbody", argc, argv, solve); }
