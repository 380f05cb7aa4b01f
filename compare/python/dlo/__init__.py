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

Numbers are in SI units, or text with a unit. Wherever a scene is asked for, the name of a scene file will do. Results
have NumPy arrays, json (the document of the command dlo), to_json(), str() (its text), and those with a shape plot(); a
notebook shows verdict, picture and text. Long calls let other threads run, and Ctrl-C ends them.
"""

from . import _documents, _functions, _loops, _parts, _scene, _studies
from ._dlo import Solution, __version__
from ._documents import *
from ._errors import ConvergenceError, InputError
from ._functions import *
from ._loops import *
from ._parts import *
from ._scene import *
from ._studies import *

__all__ = ["ConvergenceError", "InputError", "Solution", "__version__"]
__all__ += _documents.__all__
__all__ += _functions.__all__
__all__ += _loops.__all__
__all__ += _parts.__all__
__all__ += _scene.__all__
__all__ += _studies.__all__
