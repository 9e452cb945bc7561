# SPDX-License-Identifier: GPL-3.0-or-later
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, TypeVar, overload

import numpy
from numpy.typing import ArrayLike, NDArray

__version__: str

Floats = NDArray[numpy.float64]
Integers = NDArray[numpy.int64]
Booleans = NDArray[numpy.bool_]
Force = Callable[[Floats, Floats, float, Floats], Any]
Callback = TypeVar("Callback", bound=Callable[["Simulation"], Any])
AnyForce = TypeVar("AnyForce", bound=Force)

class Error(RuntimeError): ...
class InputError(Error, ValueError): ...

class SceneError(InputError):
    mistakes: Sequence[tuple[str, int | None, str]]

class PluginError(Error): ...
class NumericalError(Error, ArithmeticError): ...
class IoError(Error, OSError): ...

class Change(NamedTuple):
    faces_cut: int
    faces_torn: int
    faces_sewn: int
    elements_removed: int
    faces: Integers
    elements: Integers
    def __bool__(self) -> bool: ...

class Surface(NamedTuple):
    points: Floats
    quads: Integers
    vertices: Integers
    def values(self, of_vertices: Floats) -> Floats: ...

class EmbeddedSurface(NamedTuple):
    points: Floats
    triangles: Integers
    vertices: Integers
    weights: Floats
    elements: Integers
    laid_open: Booleans
    def values(self, of_vertices: Floats) -> Floats: ...

class Mesh:
    points: Floats
    hexahedra: Integers
    point_sets: dict[str, Integers]
    element_sets: dict[str, Integers]
    point_arrays: dict[str, Floats]
    element_arrays: dict[str, Floats]
    def __init__(
        self,
        points: ArrayLike,
        hexahedra: ArrayLike,
        point_sets: Mapping[str, ArrayLike] | None = None,
        element_sets: Mapping[str, ArrayLike] | None = None,
        point_arrays: Mapping[str, ArrayLike] | None = None,
        element_arrays: Mapping[str, ArrayLike] | None = None,
    ) -> None: ...
    @classmethod
    def from_meshio(cls, mesh: Any) -> Mesh: ...

class Record:
    @property
    def names(self) -> list[str]: ...
    @property
    def time(self) -> Floats: ...
    def __getitem__(self, name: str) -> Floats: ...
    def __len__(self) -> int: ...
    def plot(self, *names: str, ax: Any = None) -> Any: ...

class ForceTerm:
    @property
    def name(self) -> str: ...
    @property
    def calls(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def work(self) -> float: ...

class Tool:
    @property
    def name(self) -> str: ...
    @property
    def force(self) -> Floats: ...
    @property
    def torque(self) -> Floats: ...
    @property
    def translation(self) -> Floats: ...
    @property
    def rotation(self) -> Floats: ...
    @property
    def hand_force(self) -> Floats | None: ...
    @property
    def hand_torque(self) -> Floats | None: ...
    def move_to(
        self,
        translation: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
        *,
        at: float,
    ) -> None: ...

class Simulation:
    def __init__(
        self,
        scene: str | os.PathLike[str] | Mapping[str, Any],
        set: Mapping[str, Any] | None = None,
        *,
        output: bool | str | os.PathLike[str] = False,
        folder: str | os.PathLike[str] | None = None,
        mesh: Mesh | None = None,
    ) -> None: ...
    def step(self, count: int = 1) -> int: ...
    def run_to(self, time: float) -> None: ...
    def run(
        self, progress: bool | Callable[[int, float, float], Any] = False
    ) -> dict[str, Any]: ...
    @property
    def time(self) -> float: ...
    @property
    def steps(self) -> int: ...
    @property
    def dt(self) -> float: ...
    @property
    def outcome(self) -> str | None: ...
    @property
    def messages(self) -> list[str]: ...
    @property
    def title(self) -> str: ...
    @property
    def hash(self) -> str: ...
    @property
    def origin(self) -> list[float]: ...
    @property
    def position(self) -> Floats: ...
    @position.setter
    def position(self, values: ArrayLike) -> None: ...
    @property
    def velocity(self) -> Floats: ...
    @velocity.setter
    def velocity(self, values: ArrayLike) -> None: ...
    @property
    def force(self) -> Floats: ...
    @property
    def rest(self) -> Floats: ...
    @property
    def mass(self) -> Floats: ...
    @property
    def fixed(self) -> Floats: ...
    @property
    def contact_force(self) -> Floats: ...
    @property
    def gap(self) -> Floats: ...
    @property
    def tools(self) -> Mapping[str, Tool]: ...
    @property
    def point_ids(self) -> Integers: ...
    @property
    def element_ids(self) -> Integers: ...
    @property
    def vertex_exists(self) -> Booleans: ...
    @property
    def element_exists(self) -> Booleans: ...
    def columns(self) -> list[tuple[str, str, int, int, str, str]]: ...
    def column(self, model: str, name: str) -> Floats: ...
    def column_cells(self, model: str, dimension: int) -> Integers: ...
    def energies(self) -> dict[str, float]: ...
    def explain(self) -> dict[str, Any]: ...
    def cut(
        self,
        plane: Mapping[str, Any] | tuple[ArrayLike, ArrayLike] | None = None,
        *,
        surface: Mapping[str, Any] | tuple[ArrayLike, ArrayLike] | None = None,
        faces: ArrayLike | None = None,
        shape: str | None = None,
    ) -> Change: ...
    def grasp(
        self,
        name: str,
        where: Any = None,
        move: Mapping[str, Any] | None = None,
        ramp: Any = None,
        *,
        obstacle: str | None = None,
        reach: float | None = None,
    ) -> None: ...
    def release(self, name: str) -> None: ...
    def pierce(
        self,
        path: ArrayLike | None = None,
        radius: float | None = None,
        *,
        where: Any = None,
        shape: str | None = None,
    ) -> Change: ...
    def tear(
        self,
        above: float,
        by: str | Mapping[str, str] = "principal-strain",
        *,
        where: Any = None,
        most: float | None = None,
    ) -> Change: ...
    def suture(
        self,
        *,
        faces: ArrayLike | None = None,
        between: Sequence[Any] | None = None,
        gap: float | None = None,
        where: Any = None,
    ) -> Change: ...
    def remove_islands(
        self, below: int | None = None, *, outside: Mapping[str, Any] | None = None
    ) -> Change: ...
    def every(self, steps: int) -> Callable[[Callback], Callback]: ...
    def at(self, time: float) -> Callable[[Callback], Callback]: ...
    @overload
    def force_term(
        self,
        function: AnyForce,
        *,
        energy: Callable[[Floats, float], float] | None = None,
        stiffness: float | None = None,
        name: str | None = None,
    ) -> AnyForce: ...
    @overload
    def force_term(
        self,
        function: None = None,
        *,
        energy: Callable[[Floats, float], float] | None = None,
        stiffness: float | None = None,
        name: str | None = None,
    ) -> Callable[[AnyForce], AnyForce]: ...
    @property
    def force_terms(self) -> tuple[ForceTerm, ...]: ...
    def mesh(self) -> Mesh: ...
    def surface(self) -> Surface | EmbeddedSurface: ...
    def to_vtk(self, fields: Mapping[str, ArrayLike] | None = None) -> Any: ...
    def picture(
        self,
        file: str | os.PathLike[str],
        field: str | ArrayLike | None = "displacement",
        size: tuple[int, int] = (800, 600),
        edges: bool = True,
        direction: tuple[float, float, float] = (1, 0.7, 2),
    ) -> None: ...
    def record(
        self, steps: int, energies: bool = True, **functions: Callable[[Simulation], ArrayLike]
    ) -> Record: ...

class Results:
    rows: list[dict[str, Any]]
    file: os.PathLike[str]
    @property
    def columns(self) -> list[str]: ...
    @property
    def parameters(self) -> list[str]: ...
    @property
    def series_columns(self) -> list[str]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, column: str) -> NDArray[Any]: ...
    def series(self, column: str) -> list[tuple[NDArray[Any], NDArray[Any]]]: ...
    def plot(self, only: Sequence[str] = ()) -> Any: ...

def read_results(folder: str | os.PathLike[str]) -> Results: ...
def grid(parameters: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]: ...
def latin_hypercube(
    ranges: Mapping[str, tuple[float, float]],
    runs: int,
    seed: int = 0,
    log: Sequence[str] = (),
) -> list[dict[str, float]]: ...
def sweep(
    scene: str | os.PathLike[str] | Mapping[str, Any],
    parameters: Mapping[str, Sequence[Any]] | Sequence[Mapping[str, Any]],
    jobs: int | None = None,
    *,
    measure: Callable[[Simulation], Mapping[str, Any]] | None = None,
    set: Mapping[str, Any] | None = None,
    folder: str | os.PathLike[str] = "sweep",
    output: bool = False,
    report: Callable[[int, int], Any] | None = None,
) -> Results: ...
