"""Exceptions of the module."""

from __future__ import annotations

from typing import Any


class InputError(ValueError):
    """Bad input: a file, a key, a value. The message names them and what is allowed.

    key: the key at fault, such as "rod.length"; "" where it is none of a scene's.
    problem: what follows the key in the message.
    """

    def __init__(self, message: str, key: str = "", problem: str = "") -> None:
        super().__init__(message)
        self.key = key
        self.problem = problem


class ConvergenceError(RuntimeError):
    """A solver did not converge; the message states which one and why.

    result: the result so far, from which no conclusions can be drawn, or None.
    """

    def __init__(self, message: str, result: Any = None) -> None:
        super().__init__(message)
        self.result = result
