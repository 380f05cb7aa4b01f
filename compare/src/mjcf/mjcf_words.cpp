#include <algorithm>
#include <iterator>

#include "mjcf/mjcf_attributes.hpp"

namespace dlo::compare {
namespace {

// Names are those of MuJoCo's XML reference.
constexpr MjcfElement elements[] = {
    {"mujoco", "model", ""},
    {"compiler", "angle eulerseq coordinate inertiafromgeom autolimits",
     "strippath meshdir texturedir assetdir discardvisual convexhull usethread fitaabb alignfree "
     "saveinertial balanceinertia exactmeshinertia"},
    {"option", "gravity wind density viscosity",
     "timestep apirate impratio tolerance ls_tolerance noslip_tolerance ccd_tolerance "
     "mpr_tolerance magnetic o_margin o_solref o_solimp o_friction integrator cone jacobian solver "
     "iterations ls_iterations noslip_iterations ccd_iterations mpr_iterations sdf_iterations "
     "sdf_initpoints actuatorgroupdisable sleep_tolerance"},
    {"flag", "gravity passive spring equality contact constraint",
     "frictionloss limit damper clampctrl warmstart filterparent actuation refsafe sensor midphase "
     "nativeccd eulerdamp autoreset island override energy fwdinv invdiscrete multiccd sleep "
     "diagexact"},
    {"body", "name childclass pos quat axisangle xyaxes zaxis euler mocap gravcomp", "user sleep"},
    {"frame", "childclass pos quat axisangle xyaxes zaxis euler", "name"},
    {"joint",
     "type class pos axis stiffness springref ref springdamper limited range frictionloss kind",
     "name group damping armature margin solreflimit solimplimit solreffriction solimpfriction "
     "user actuatorfrcrange actuatorfrclimited actuatorgravcomp"},
    {"freejoint", "", "name group align"},
    {"geom",
     "name class type size pos quat axisangle xyaxes zaxis euler fromto mass density contype "
     "conaffinity friction shellinertia",
     "group priority condim solmix solref solimp margin gap material rgba user fluidshape "
     "fluidcoef"},
    {"inertial", "mass pos", "quat axisangle xyaxes zaxis euler diaginertia fullinertia"},
    {"site", "name class pos quat axisangle xyaxes zaxis euler",
     "type size group material rgba user"},
    {"composite", "prefix type count offset quat curve initial size vertex", ""},
    {"plugin", "plugin instance", ""},
    {"instance", "name", ""},
    {"config", "key value", ""},
    {"weld", "class active body1 body2 relpose anchor site1 site2",
     "name solref solimp torquescale"},
    {"connect", "class active body1 body2 anchor site1 site2", "name solref solimp"},
    {"default", "class", ""},
    {"worldbody", "", ""},
    {"equality", "", ""},
    {"extension", "", ""},
};

}  // namespace

const MjcfElement* mjcf_element(std::string_view name) {
  const auto* const found = std::ranges::find(elements, name, &MjcfElement::name);
  return found == std::end(elements) ? nullptr : found;
}

bool mjcf_without_effect(std::string_view name) {
  constexpr std::string_view all[] = {"visual", "statistic", "size",    "asset",
                                      "sensor", "keyframe",  "custom",  "light",
                                      "camera", "skin",      "actuator"};
  return std::ranges::find(all, name) != std::end(all);
}

}  // namespace dlo::compare
