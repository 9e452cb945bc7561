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

from ._simulation import Change, Simulation
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
from ._surfaces import EmbeddedSurface, Surface

_later = {  # what needs more than the kernel is imported when it is first used
    "Adjoint": "_gradients",
    "FitResult": "_fit_results",
    "GradientCheck": "_gradients",
    "Live": "_live",
    "Mesh": "_mesh",
    "ModelParameters": "_parameters",
    "Picture": "_draw",
    "Quantity": "_gradients",
    "Record": "_record",
    "Results": "_study_results",
    "RunAdjoint": "_run_gradients",
    "Sensitivity": "_gradients",
    "Tool": "_tools",
    "check_gradient": "_gradients",
    "fit": "_fit",
    "gradient": "_gradients",
    "grid": "_sweep",
    "latin_hypercube": "_sweep",
    "read_fit_result": "_fit_results",
    "read_results": "_study_results",
    "sweep": "_sweep",
}


def __getattr__(name):
    if name not in _later:
        raise AttributeError(f"module 'suture' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module("." + _later[name], __name__), name)


def __dir__():
    return sorted({*globals(), *__all__})


__all__ = [
    "Adjoint",
    "Change",
    "EmbeddedSurface",
    "Error",
    "FitResult",
    "ForceTerm",
    "GradientCheck",
    "InputError",
    "IoError",
    "Live",
    "Mesh",
    "ModelParameters",
    "NumericalError",
    "Picture",
    "PluginError",
    "Quantity",
    "Record",
    "Results",
    "RunAdjoint",
    "SceneError",
    "Sensitivity",
    "Simulation",
    "State",
    "Surface",
    "Tool",
    "check_gradient",
    "fit",
    "gradient",
    "grid",
    "latin_hypercube",
    "read_fit_result",
    "read_results",
    "sweep",
]
