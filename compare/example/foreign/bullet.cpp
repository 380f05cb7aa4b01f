// A scene as Bullet solves it, for dlo bench and dlo regress (compare/doc/protocol.md).
//
//     bullet SCENE SHAPE
//
// SCENE is what `dlo scene --format json` writes, SHAPE becomes a CSV file of the rod's axis. The
// rod is a btMultiBody (Featherstone's algorithm) with a spherical joint at each hinge; a second
// clamp is a btMultiBodyFixedConstraint. Only the shape at rest is computed, which does not depend
// on masses. Each body therefore has equal moments of inertia and almost no mass, so that the
// number of steps to rest is proportional to N, not to N^2. The weight is applied as a force.
// Velocities are set to zero whenever the speed has decreased (kinetic damping). Needs Bullet
// in double precision.

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyFixedConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "chain.hpp"

namespace {

using foreign::Chain;
using foreign::Quaternion;
using foreign::Vector;

constexpr double moment_of_inertia = 1;  // moment of inertia of each body about its end [kg m^2]
constexpr double at_rest = 1e-13;        // rotation in a step at the highest speed [rad]

btVector3 to_bullet(const Vector& v) { return {v[0], v[1], v[2]}; }
btQuaternion to_bullet(const Quaternion& q) { return {q[1], q[2], q[3], q[0]}; }

/// Returns the time step [s]: an eighth of the stability limit 2 / omega. omega is the frequency of
/// the fastest motion, in which hinges rotate in zigzag: omega^2 is 4 k / I from their stiffness,
/// which doubles at right angles, plus F h / I from the weight. The margin is for larger rotations.
double time_step(const Chain& chain) {
  const double h = chain.segment.front();
  double stiffness = 0;
  double weight = 0;
  for (const foreign::Hinge& hinge : chain.hinges) {
    stiffness = std::max(stiffness, std::max(hinge.bend, hinge.twist));
  }
  for (const Vector& force : chain.force) weight += foreign::length(force);
  return 0.25 / std::sqrt((8 * stiffness + weight * h) / moment_of_inertia);
}

class Simulation {
 public:
  explicit Simulation(const Chain& chain)
      : chain_(chain),
        links_(static_cast<int>(chain.hinges.size())),
        step_(time_step(chain)),
        body_(links_, 0, {0, 0, 0}, true, false),
        collider_(&body_, links_ - 1),
        clamp_(&body_, links_ - 1, nullptr, {-chain.segment.back(), 0, 0},
               to_bullet(chain.last_hinge), btMatrix3x3::getIdentity(),
               btMatrix3x3(to_bullet(chain.frames.back()))) {
    build();
    world_.setGravity({0, 0, 0});
    world_.getSolverInfo().m_numIterations = 30;
    world_.addMultiBody(&body_);
    if (chain.second_clamp) hold_end();
  }
  ~Simulation() {
    world_.removeMultiBodyConstraint(&clamp_);
    world_.removeCollisionObject(&collider_);
    world_.removeMultiBody(&body_);
  }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  Simulation(Simulation&&) = delete;
  Simulation& operator=(Simulation&&) = delete;

  void run_to_rest() {
    double before = 0;
    int calm = 0;
    for (int i = 0; calm < 3; ++i) {
      if (i == 2000000) throw std::runtime_error("not at rest");
      apply_forces();
      world_.stepSimulation(step_, 0);
      double now = motion();
      if (now <= before) {  // both are 0 if the rod starts at rest
        body_.clearVelocities();
        calm = before < at_rest * at_rest ? calm + 1 : 0;
        now = 0;
      }
      before = now;
    }
  }

  /// Returns the positions of the hinges and of the tip, beginning with the first hinge.
  [[nodiscard]] std::vector<Vector> points() const {
    std::vector<Vector> result = {chain_.first_point};
    for (int i = 0; i < links_; ++i) {
      const btVector3 p = body_.localPosToWorld(i, {0, 0, 0});
      result.push_back({p.x(), p.y(), p.z()});
    }
    return result;
  }

 private:
  /// Builds the multibody. Link i ends at the point i + 2, where its mass is.
  void build() {
    body_.setBasePos(to_bullet(chain_.first_point));
    body_.setWorldToBaseRot(to_bullet(chain_.frames.front()).inverse());
    // The moment of inertia of all masses at the rod's end, about the first hinge, is negligible.
    const double length = chain_.segment.front() * links_;
    const double mass = 1e-4 * moment_of_inertia / (length * length * links_);
    for (int i = 0; i < links_; ++i) {
      body_.setupSpherical(i, mass, {moment_of_inertia, moment_of_inertia, moment_of_inertia},
                           i - 1, btQuaternion::getIdentity(), {0, 0, 0},
                           {chain_.segment[static_cast<std::size_t>(i) + 1], 0, 0});
    }
    body_.finalizeMultiDof();
    for (int i = 0; i < links_; ++i) {
      const auto [w, x, y, z] = chain_.turn(static_cast<std::size_t>(i));
      const std::array<btScalar, 4> position = {x, y, z, w};
      body_.setJointPosMultiDof(i, position.data());
    }
    body_.setLinearDamping(0);
    body_.setAngularDamping(0);
    body_.setMaxCoordinateVelocity(1e9);
  }

  /// Bullet solves constraints by groups of bodies that may touch: for a body without a collider it
  /// solves none.
  void hold_end() {
    collider_.setCollisionShape(&shape_);
    body_.getLink(links_ - 1).m_collider = &collider_;
    world_.addCollisionObject(&collider_, 0, 0);
    clamp_.finalizeMultiDof();
    clamp_.setMaxAppliedImpulse(1e9);
    world_.addMultiBodyConstraint(&clamp_);
  }

  void apply_forces() {
    body_.clearForcesAndTorques();
    for (int i = 0; i < links_; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      const btScalar* q = body_.getJointPosMultiDof(i);
      const Vector torque = foreign::torque(chain_.hinges[joint], {q[3], q[0], q[1], q[2]});
      body_.addJointTorqueMultiDof(i, torque.data());
      body_.addLinkForce(i, to_bullet(chain_.force[joint + 2]));
    }
  }

  /// Returns the sum of the squared rotations of the hinges in the last step, a measure of the
  /// kinetic energy.
  [[nodiscard]] double motion() const {
    double sum = 0;
    for (int i = 0; i < links_; ++i) {
      const btScalar* speed = body_.getJointVelMultiDof(i);
      for (int k = 0; k < 3; ++k) sum += speed[k] * speed[k] * step_ * step_;
    }
    return sum;
  }

  const Chain& chain_;
  int links_;
  double step_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btMultiBody body_;
  btEmptyShape shape_;
  btMultiBodyLinkCollider collider_;
  btMultiBodyFixedConstraint clamp_;
};

}  // namespace

int main(int argc, char** argv) {
  return foreign::run("bullet", argc, argv, [](const Chain& chain) {
    Simulation simulation(chain);
    simulation.run_to_rest();
    return simulation.points();
  });
}
