# SPDX-License-Identifier: Apache-2.0
"""Scenes made of arrays."""

import operator
import os
import pathlib
import shutil
import tempfile
import weakref
from typing import Any, Dict, List, Optional, Sequence, Tuple

from . import _library as _l
from ._library import Error
from ._simulation import Simulation, open as _open

Table = Dict[str, Any]


def _toml(value: Any) -> str:
    value = _l.plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        text = os.fspath(value)
        for sign, escaped in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("\t", "\\t")):
            text = text.replace(sign, escaped)
        return '"%s"' % text
    if isinstance(value, dict):
        return "{ %s }" % ", ".join("%s = %s" % (_key(key), _toml(one)) for key, one in value.items())
    if hasattr(value, "__index__"):
        return str(operator.index(value))
    if hasattr(value, "__len__"):
        return "[%s]" % ", ".join(_toml(one) for one in value)
    return repr(float(value))


def _key(key: str) -> str:
    return key if key.isascii() and key.replace("_", "a").replace("-", "a").isalnum() else _toml(key)


class _Folder:
    """A temporary folder that exists as long as this object."""

    def __init__(self) -> None:
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="c3de-"))
        weakref.finalize(self, shutil.rmtree, str(self.path), ignore_errors=True)


class Scene:
    """A scene whose bodies are triangle meshes in arrays. Keys are those of the scene file; values are numbers, text,
    lists and dicts. Units are SI. For example::

        scene = c3de.Scene("block", world={"gravity": [0, 0, -9.81]}, solver={"integrator": "quasistatic"})
        scene.body("block", vertices, triangles, material={"youngs_modulus": 1e4}, sampling={"spacing": 0.01})
        scene.fix("block", {"box": {"min": [-1, -1, -0.001], "max": [1, 1, 0.001]}})
        sim = scene.open()
    """

    def __init__(self, title: str = "Python", *, world: Optional[Table] = None, solver: Optional[Table] = None,
                 **tables: Table):
        self._title = title
        self._tables: List[Tuple[str, Table]] = []
        self._arrays: List[Tuple[str, Table]] = []
        self._folder = _Folder()
        for name, table in [("world", world), ("solver", solver), *tables.items()]:
            if table:
                self._tables.append((name, dict(table)))

    def body(self, name: str, vertices: Sequence[Sequence[float]], triangles: Sequence[Sequence[int]],
             **keys: Any) -> "Scene":
        """A body inside a closed surface: vertices (n, 3), m; triangles (m, 3), indices from 0, counter-clockwise seen
        from outside. keys: material, sampling, position, … of [[body]]."""
        rows = ["v %r %r %r\n" % tuple(float(x) for x in self._row(vertex, "vertices")) for vertex in vertices]
        count = len(rows)
        for triangle in triangles:
            corners = [int(index) for index in self._row(triangle, "triangles")]
            if min(corners) < 0 or max(corners) >= count:
                raise Error("triangles has %r; accepted: 0 to %d" % (corners, count - 1), _l.E_ARG)
            rows.append("f %d %d %d\n" % tuple(index + 1 for index in corners))
        file = self._folder.path / ("mesh%d.obj" % len(self._arrays))
        file.write_text("".join(rows))
        return self.add("body", name=name, mesh=file.name, mesh_unit="m", **keys)

    def fix(self, body: str, region: Table, **keys: Any) -> "Scene":
        """Holds the part of a body in a region, or moves it: displacement (m), rotation_deg, ramp (s)."""
        return self.add("fix", body=body, region=region, **keys)

    def load(self, body: str, region: Table, **keys: Any) -> "Scene":
        """A force (N, total) or a pressure (Pa) on the part of a body in a region; ramp (s)."""
        return self.add("load", body=body, region=region, **keys)

    def probe(self, name: str, body: str, at: Sequence[float], **keys: Any) -> "Scene":
        """A material point (m) to follow."""
        return self.add("probe", name=name, body=body, at=at, **keys)

    def add(self, table: str, **keys: Any) -> "Scene":
        """Another table of the scene file, [[table]]."""
        self._arrays.append((table, keys))
        return self

    @staticmethod
    def _row(row: Sequence[Any], name: str) -> Sequence[Any]:
        if len(row) != 3:
            raise Error("%s has a row of %d; accepted: 3" % (name, len(row)), _l.E_ARG)
        return row

    @property
    def text(self) -> str:
        """The scene as TOML."""
        lines = ["format = 1", "title = %s" % _toml(self._title)]
        for form, tables in (("[%s]", self._tables), ("[[%s]]", self._arrays)):
            for name, table in tables:
                lines += ["", form % name] + ["%s = %s" % (_key(key), _toml(value)) for key, value in table.items()]
        return "\n".join(lines) + "\n"

    def open(self, **options: Any) -> Simulation:
        """As c3de.open(), without path and text. The meshes exist as long as the scene or the simulation."""
        simulation = _open(self._folder.path / "scene.toml", text=self.text, **options)
        simulation._kept = self._folder
        return simulation

    def __repr__(self) -> str:
        return "<c3de.Scene %r, %d bodies>" % (self._title, sum(name == "body" for name, _ in self._arrays))
