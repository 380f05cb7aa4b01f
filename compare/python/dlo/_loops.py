"""The force model, step by step."""

from __future__ import annotations

from typing import Iterable, Optional

from numpy.typing import ArrayLike

from . import _dlo
from ._arguments import COUNT, INDEX, INTEGER, LIST, NUMBER, require, told
from ._scene import SceneLike, data_of

__all__ = ["Batch", "ForceModel"]


class ForceModel(_dlo.ForceModel):
    """A scene's force model in a loop of your own: step, move grippers and walls, read points.

        loop = dlo.ForceModel(scene)
        points = numpy.empty((len(loop), 3))
        while True:
            loop.move_gripper(0, position=hand())
            loop.step(30)
            loop.points(out=points)

    points: where it starts [m], shape (N, 3); None: straight from one gripper, between several where
    its polygon rests. grip_stiffness: of springs that hold the points instead of rigid grips, as a
    haptic device feels them [N/m]; None: rigid. N, law and stepper are scene.force_model's.

    Threads may share one: each call has it to itself. step() lets others run meanwhile. A signal handler
    that interrupts step() may not call it: RuntimeError.
    """

    def __init__(
        self,
        scene: SceneLike,
        points: Optional[ArrayLike] = None,
        *,
        grip_stiffness: Optional[float] = None,
    ) -> None:
        if grip_stiffness is not None:
            require("grip_stiffness", grip_stiffness, NUMBER)
        super().__init__(data_of(scene), points, grip_stiffness)

    step = told(_dlo.ForceModel.step, count=COUNT)
    rest = told(_dlo.ForceModel.rest, tolerance=NUMBER, max_steps=COUNT, time_limit=NUMBER)
    move_gripper = told(_dlo.ForceModel.move_gripper, gripper=INDEX)
    move_wall = told(_dlo.ForceModel.move_wall, wall=INDEX)


class Batch(_dlo.Batch):
    """Many rods at once, eight in lockstep, on several threads: for tables of simulations.

    All scenes have the same force_model.points, law and stepper, and start as a ForceModel of each.
    threads: 0: all cores.
    """

    def __init__(self, scenes: Iterable[SceneLike], *, threads: int = 0) -> None:
        require("scenes", scenes, LIST)
        require("threads", threads, INTEGER)
        super().__init__([data_of(scene) for scene in scenes], threads)

    step = told(_dlo.Batch.step, count=COUNT)
    move_gripper = told(_dlo.Batch.move_gripper, rod=INDEX, gripper=INDEX)
