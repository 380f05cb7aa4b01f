"""A time limit for functions that are not ours."""

from __future__ import annotations

import ctypes
import threading
from typing import Any, Callable


class _TimeIsUp(BaseException):
    """Exception that a function's own `except Exception` does not catch."""


def _raise_in(thread: int, error: Any) -> None:
    """Raises an exception in a thread between two of its instructions; None withdraws one not raised yet."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(
        ctypes.c_ulong(thread), None if error is None else ctypes.py_object(error)
    )


def within(seconds: float, function: Callable[..., Any]) -> Callable[..., Any]:
    """Returns the function with a time limit, after which it raises TimeoutError; a call of C ends first."""

    def call(*arguments: Any) -> Any:
        thread, lock = threading.get_ident(), threading.Lock()
        done, is_late = threading.Event(), threading.Event()

        def watch() -> None:
            if done.wait(min(seconds, threading.TIMEOUT_MAX)):
                return
            with lock:
                if not done.is_set():
                    is_late.set()
                    _raise_in(thread, _TimeIsUp)

        threading.Thread(target=watch, daemon=True).start()
        try:
            try:
                made = function(*arguments)
            finally:
                with lock:  # after this nothing is raised any more
                    done.set()
                    _raise_in(thread, None)
        except (Exception, _TimeIsUp):
            if not is_late.is_set():
                raise
        if is_late.is_set():
            raise TimeoutError(f"ended after the time limit of {seconds:g} s")
        return made

    return call
