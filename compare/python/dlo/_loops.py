"""The force model, step by step."""

from __future__ import annotations

from typing import Iterable, Optional

from numpy.typing import ArrayLike

from . import _dlo
from ._arguments import COUNT, INDEX, INTEGER, LIST, NUMBER, require, told
from ._scene import SceneLike, data_of

__all__ = ["Batch", "ForceModel"]


class ForceModel(_dlo.ForceModel):
    """Force model of a scene for a loop of your own: step, move grippers and walls, read points.

        loop = dlo.ForceModel(scene)
        points = numpy.empty((len(loop), 3))
        while True:
            loop.move_gripper(0, position=hand())
            loop.step(30)
            loop.points(out=points)

    points: initial points [m], shape (N, 3); None: straight from one gripper, between several the polygon's
    rest shape. grip_stiffness: stiffness [N/m] of springs that hold the points instead of rigid grips, as a
    haptic device feels them; None: rigid. N, law and stepper (not verlet) are those of scene.force_model.

    Threads may share an object: its calls exclude each other, and step() lets other threads run. Calls by a
    signal handler that interrupts step() raise RuntimeError.
    """

    def __init__(
        self, scene: SceneLike, points: Optional[ArrayLike] = None, *, grip_stiffness: Optional[float] = None
    ) -> None:
        if grip_stiffness is not None:
            require("grip_stiffness", grip_stiffness, NUMBER)
        super().__init__(data_of(scene), points, grip_stiffness)

    step = told(_dlo.ForceModel.step, count=COUNT)
    rest = told(_dlo.ForceModel.rest, tolerance=NUMBER, max_steps=COUNT, time_limit=NUMBER)
    move_gripper = told(_dlo.ForceModel.move_gripper, gripper=INDEX)
    move_wall = told(_dlo.ForceModel.move_wall, wall=INDEX)


class Batch(_dlo.Batch):
    """Steps many rods at once, in vectorised blocks of eight, on several threads: for tables of simulations.

    Scenes must have the same force_model.points, law and stepper (not verlet or implicit), all or none natural
    curvature, and no two grippers that hold the rod's frame. They start like ForceModel. threads: 0: all cores.
    """

    def __init__(self, scenes: Iterable[SceneLike], *, threads: int = 0) -> None:
        require("scenes", scenes, LIST)
        require("threads", threads, INTEGER)
        super().__init__([data_of(scene) for scene in scenes], threads)

    step = told(_dlo.Batch.step, count=COUNT)
    move_gripper = told(_dlo.Batch.move_gripper, rod=INDEX, gripper=INDEX)
