"""Names of files."""

from __future__ import annotations

import os
from typing import Any, Optional, Union

from . import _dlo
from ._errors import InputError

FileName = Union[str, "os.PathLike[str]"]

Materials = Optional[tuple[str, str]]
"""Text and name of a file of materials; None: the built-in file."""


def file_name(path: Any, what: str, allowed: str = "the name of a file") -> bytes:
    """Returns the name of a file in the encoding of the system."""
    if not isinstance(path, (str, bytes, os.PathLike)):
        raise InputError(f"{what}: a {type(path).__name__} (allowed: {allowed})")
    # The name of a file may contain any bytes, the name of a scene is Unicode.
    try:
        name = os.fsencode(path)
    except UnicodeEncodeError:
        raise InputError(f"{what}: a file's name with an unpaired surrogate (allowed: Unicode)") from None
    if b"\0" in name:
        raise InputError(f"{what}: a file's name with a zero byte (allowed: any other)")
    return name


def file_text(name: bytes) -> tuple[str, str]:
    """Returns the content of a file, and its name for messages."""
    return _dlo.read_file(name), name.decode(errors="replace")


def materials_file(path: Optional[FileName]) -> Materials:
    return None if path is None else file_text(file_name(path, "materials"))
