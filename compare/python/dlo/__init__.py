"""Is the shape that your rod simulator draws the shape that the material would take?

    import dlo
    scene = dlo.Scene(length="2 m", diameter="6 mm", material="silicone",
                      grippers=[dlo.clamp(at=0, position=(0, 0, 0), direction="30 deg")])
    print(dlo.check(scene, points, tolerance="1%"))      # points: an array of shape (M, 3), in m

Scenes       Scene, clamp, pin, load, distributed_load, obstacle, section, materials
One shape    solve, solve_all, check, compare, plan, calibrate
Many         sweep, regress, bench, stability, modes, suite
Motion       track
In a loop    ForceModel, Batch
Errors       InputError (a ValueError), ConvergenceError (a RuntimeError)

Numbers are in SI units, or text with a unit. Wherever a scene is asked for, the name of a scene file
will do. Results have NumPy arrays, json (the document of the command dlo), to_json(), str() (its
text), and those with a shape plot(); a notebook shows verdict, picture and text. Long calls let other threads run, and Ctrl-C ends them.
"""

from ._dlo import Check, Comparison, Equilibria, Solution, __version__
from ._documents import (
    Benchmark,
    Document,
    ForceModelFit,
    MaterialFit,
    Modes,
    MotionCheck,
    MotionFit,
    Plan,
    Regression,
    ScoreCard,
    Stability,
    Track,
)
from ._errors import ConvergenceError, InputError
from ._functions import calibrate, check, compare, plan, solve, solve_all
from ._loops import Batch, ForceModel
from ._parts import (
    DistributedLoad,
    ForceModelSettings,
    Gripper,
    Load,
    Medium,
    Obstacle,
    Section,
    TrackRates,
    clamp,
    distributed_load,
    load,
    obstacle,
    pin,
    section,
)
from ._scene import Scene, materials
from ._studies import bench, modes, regress, stability, suite, sweep, track

__all__ = [
    "Batch",
    "Benchmark",
    "Check",
    "Comparison",
    "ConvergenceError",
    "DistributedLoad",
    "Document",
    "Equilibria",
    "ForceModel",
    "ForceModelFit",
    "ForceModelSettings",
    "Gripper",
    "InputError",
    "Load",
    "MaterialFit",
    "Medium",
    "Modes",
    "MotionCheck",
    "MotionFit",
    "Obstacle",
    "Plan",
    "Regression",
    "Scene",
    "ScoreCard",
    "Section",
    "Solution",
    "Stability",
    "Track",
    "TrackRates",
    "__version__",
    "bench",
    "calibrate",
    "check",
    "clamp",
    "compare",
    "distributed_load",
    "load",
    "materials",
    "modes",
    "obstacle",
    "pin",
    "plan",
    "regress",
    "section",
    "solve",
    "solve_all",
    "stability",
    "suite",
    "sweep",
    "track",
]
