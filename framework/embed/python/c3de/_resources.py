# SPDX-License-Identifier: Apache-2.0
"""Files that come with the program."""

import pathlib

from . import _library as _l
from ._library import Error


def resource(name: str) -> pathlib.Path:
    """The path of a file that comes with the program: scenes, meshes, material presets. For example
    c3de.resource("scenes/cantilever.toml").

    Raises Error of kind "not found": where it was looked for.
    """
    prefix = pathlib.Path(__file__).resolve().parents[4]  # PREFIX/lib/python3/dist-packages/c3de/_resources.py
    # The second is that of a build folder.
    candidates = [prefix / "share" / "c3de" / name, prefix.parent.parent / "resources" / name]
    for candidate in candidates:
        if candidate.exists():
            return candidate
    raise Error("the resource %r is missing; looked for: %s" % (name, ", ".join(map(str, candidates))), _l.E_NOT_FOUND)
