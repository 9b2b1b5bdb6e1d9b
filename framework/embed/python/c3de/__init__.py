# SPDX-License-Identifier: Apache-2.0
"""Simulations of C3DE in Python.

Units are SI: m, kg, s, N, Pa. For example::

    import c3de
    with c3de.open("liver.toml", **{"body.liver.youngs_modulus": 6e3}) as sim:
        sim.run(until=0.5)
        u = sim.body("liver").points.field("displacement")   # (n, 3), m

open() and Scene make a Simulation; its bodies have points, a surface and fields. sweep() simulates with many values.
match() brings a body to measured points, fit() finds its stiffness from a measured curve.
Simulation.picture() draws, Simulation.show() opens the window.

Arrays need numpy (Debian package python3-numpy); everything else works without it. Errors are c3de.Error with the text
of the program. Any thread may call; calls to the same simulation are serialised.
"""

from ._bodies import Body, Hold, PointSet, Surface
from ._conditions import Condition
from ._images import Label, WarpedImage
from ._inverse import Fit, Match, Modulus, Sensitivity, SupportSensitivity, fit, match
from ._library import Error, version
from ._pictures import Window, program
from ._recording import Recording, Replayed, replay
from ._resources import resource
from ._scene import Scene
from ._simulation import Event, Parameter, Simulation, Status, open
from ._sweep import SweepRow, sweep

__version__ = version()
__all__ = ["Body", "Condition", "Error", "Event", "Fit", "Hold", "Label", "Match", "Modulus", "Parameter", "PointSet",
           "Recording", "Replayed", "Scene", "Sensitivity", "Simulation", "Status", "SupportSensitivity", "Surface",
           "SweepRow", "WarpedImage", "Window", "fit", "match", "open", "program", "replay", "resource", "sweep",
           "version"]
