# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft bodies that are cut while they move, as a Python module.

    import suture
    sim = suture.Simulation("cut-beam.json")
    sim.run_to(0.5)
    sim.cut(plane=([1, 0, 0], [1, 0, 0]))
    sim.run()
    print(sim.position[:, 1].min(), sim.energies())

The module contains the same kernel as the program `suture` and gives the same bits.
docs/python.md is its guide.
"""

from ._simulation import Change, EmbeddedSurface, Simulation, Surface
from ._suture import (
    Error,
    ForceTerm,
    InputError,
    IoError,
    NumericalError,
    PluginError,
    SceneError,
    State,
    version as __version__,
)



def __getattr__(name):
    """What needs more than the kernel is imported when it is first used."""
    if name == "Mesh":
        from ._mesh import Mesh

        return Mesh
    if name in ("grid", "latin_hypercube", "sweep"):
        from . import _sweep

        return getattr(_sweep, name)
    if name == "Tool":
        from ._tools import Tool

        return Tool
    raise AttributeError(f"module 'suture' has no attribute {name!r}")


__all__ = [
    "Change",
    "EmbeddedSurface",
    "Error",
    "ForceTerm",
    "InputError",
    "IoError",
    "Mesh",
    "NumericalError",
    "PluginError",
    "SceneError",
    "Simulation",
    "State",
    "Surface",
    "Tool",
    "grid",
    "latin_hypercube",
    "sweep",
]
