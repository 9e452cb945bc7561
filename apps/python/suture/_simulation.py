# SPDX-License-Identifier: GPL-3.0-or-later
"""The class Simulation: arguments, events and callbacks on top of the compiled half."""

import os
from collections.abc import Mapping
from typing import NamedTuple

from . import _suture
from ._scene import set_texts, source_of, to_json
from ._surfaces import EmbeddedSurface, Surface, surface_arrays


class Change(NamedTuple):
    """What an operation changed. True if it changed anything."""

    faces_cut: int
    faces_torn: int
    faces_sewn: int
    elements_removed: int
    faces: "numpy.ndarray"
    """(k, 2) int64: the elements on both sides of every face, by the user's numbers."""
    elements: "numpy.ndarray"
    """(k,) int64: the elements that were removed, by the user's numbers."""
    elements_cut: int
    """The elements that were divided along the blade."""

    def __bool__(self):
        return (self.faces_cut + self.faces_torn + self.faces_sewn + self.elements_removed
                + self.elements_cut > 0)


def _without_none(**values):
    return {key: value for key, value in values.items() if value is not None}


def _one_of(**values):
    given = _without_none(**values)
    if len(given) != 1:
        names = ", ".join(values)
        raise TypeError(f"give exactly one of {names}; {len(given)} are given")
    return given.popitem()


def _take_mesh(scene, mesh):
    """Takes a Mesh out of a dict."""
    if isinstance(scene, Mapping) and hasattr(scene.get("mesh"), "hexahedra"):
        if mesh is not None:
            raise TypeError("the mesh is given twice: in the scene and as mesh=")
        mesh = scene["mesh"]
        scene = {key: value for key, value in scene.items() if key != "mesh"}
    is_read = isinstance(mesh, _suture.ReadMesh)  # by a study, for all of its runs
    if mesh is not None and not is_read and not hasattr(mesh, "element_sets"):
        raise TypeError(f"mesh must be a suture.Mesh, is {type(mesh).__name__}; see "
                        "Mesh(points, hexahedra) and Mesh.from_meshio()")
    return scene, mesh


class Simulation(_suture.Simulation):
    """A scene that runs, step by step, under your control.

    scene   path of a scene file, a dict, or a JSON text
    set     values that replace those of the scene, as --set does: {"/solver/dt": 1e-4}
    output  True: write the frames and tables that the scene's /output asks for, as the program
            does; a path: to this folder instead of /output/directory; False: write nothing
    folder  for a dict or a text: the folder that mesh, plugin and blade files are relative to
            (default: the working folder)
    mesh    a Mesh of arrays, in place of the one of the scene. In a dict, the Mesh may also
            be the value of "mesh"

    Mistakes raise SceneError, whose attribute `mistakes` lists them all.

    Arrays are views on the kernel's own memory: nothing is copied, and they follow the motion.
    Vertex arrays have one row per vertex; an operation may append rows. An array taken before an
    operation keeps the values of that moment; take it again from the simulation. All arrays are
    read-only; assign to `position` or `velocity` to change the motion.
    Positions are relative to `origin`, the lower corner of the mesh at rest.
    """

    def __init__(self, scene, set=None, *, output=False, folder=None, mesh=None):
        scene, mesh = _take_mesh(scene, mesh)
        text, file, is_text = source_of(scene, folder)
        try:
            super().__init__(text, file, is_text, set_texts(set), mesh, bool(output),
                             os.fspath(output) if isinstance(output, (str, os.PathLike)) else "")
        except _suture.SceneError as error:
            if is_text and not isinstance(scene, str):  # a dict has no lines
                error.mistakes = [(path, None, what) for path, _, what in error.mistakes]
            raise
        self._terms = []

    def __setattr__(self, name, value):
        """What the simulation would ignore is refused."""
        if not (name.startswith("_") or hasattr(type(self), name)):
            import difflib

            near = difflib.get_close_matches(name, dir(type(self)), 1)
            raise AttributeError(
                f"a simulation has no {name!r} to assign" +
                (f"; did you mean {near[0]!r}?" if near else
                 "; parameters of models are in sim.parameters[model][name]"))
        super().__setattr__(name, value)

    def __repr__(self):
        try:
            elements = f"{len(self.element_ids)} elements"
        except RuntimeError:
            elements = "running in another thread"
        return (f"<suture.Simulation {self.title or self.hash!r}: step {self.steps}, "
                f"t = {self.time:g} s, {elements}>")

    # ---- steps ----

    def run(self, progress=False):
        """Run to the end of the scene; return a dict that summarises the run.

        progress  True: a bar of tqdm, where it is installed; or a function (step, time, end)

        Ctrl-C, and an exception in a callback, stop the run between two steps; run() or step()
        continues it.
        """
        if progress is not True:
            return self._run(progress or None)
        from ._progress import bar

        with bar() as update:
            return self._run(update)

    # ---- events ----

    def _operate(self, operation, what, shape=None):
        event = {operation: what}
        if shape is not None:
            event["shape"] = shape
        return Change(*self._apply(to_json(event), operation + "()"))

    def cut(self, plane=None, *, surface=None, faces=None, shape=None, along=None):
        """Cut now; return a Change.

        plane    (point, normal), m, or a dict as in a scene: point, normal, radius, or polygon
        surface  (vertices, triangles): arrays (n, 3) in m and (k, 3); or a dict as in a scene
        faces    pairs of elements [(4, 5), ...] by the user's numbers
        shape    "deformed" (default) or "rest": where plane and surface lie
        along    "faces": open faces of elements; or "blade": divide the elements that the plane or
                 the surface crosses. The scene must have such a cut among its events; it is then the
                 default in version 2 of the format.
        """
        kind, blade = _one_of(plane=plane, surface=surface, faces=faces)
        if kind == "plane" and not isinstance(blade, dict):
            point, normal = blade
            blade = {"point": point, "normal": normal}
        if kind == "surface" and not isinstance(blade, dict):
            if shape not in (None, "deformed", "rest"):
                raise ValueError(f"shape must be 'deformed' or 'rest', is {shape!r}")
            if along not in (None, "faces", "blade"):
                raise ValueError(f"along must be 'faces' or 'blade', is {along!r}")
            return Change(*self._cut_surface(*surface_arrays(blade), shape == "rest",
                                             along and along == "blade"))
        return self._operate("cut", _without_none(**{kind: blade}, along=along), shape)

    def grasp(self, name, where=None, move=None, ramp=None, *, obstacle=None, reach=None):
        """Hold the nodes that a selection names in the deformed shape, from where they are, or
        those that an obstacle touches.

        move, ramp  a motion as in a scene, whose times count from now; None: stay
        obstacle    name of the obstacle that holds the nodes and moves them along
        reach       how far from the obstacle they may be, m
        """
        self._operate("grasp", _without_none(name=name, where=where, move=move, ramp=ramp,
                                             obstacle=obstacle, reach=reach))

    def move_grasp(self, name, translation, *, at):
        """Move what a grasp holds from where it is now by a translation (m), at a constant velocity
        until the time `at` (s), and hold it there."""
        from ._tools import _vector
        self._move_grasp(name, _vector(translation, "translation"), float(at))

    def release(self, name):
        """Let go of a grasp, or of a constraint with a name. The nodes keep their velocities."""
        self._operate("release", name)

    def pierce(self, path=None, radius=None, *, where=None, shape=None):
        """Remove the elements around a path of points (n, 3), up to radius (m) from their
        centroids, or those that a selection names (where); return a Change."""
        return self._operate("pierce", _without_none(path=path, radius=radius, where=where), shape)

    def tear(self, above, by="principal-strain", *, where=None, most=None):
        """Open faces where a value exceeds a threshold; return a Change.

        by  "principal-strain", "elongation" or {"model": ..., "field": ...}
        """
        return self._operate("tear", _without_none(by=by, above=above, where=where, most=most))

    def suture(self, *, faces=None, between=None, gap=None, where=None):
        """Sew boundary faces: pairs of elements (faces), what lies within gap (m) of each other
        between two selections, or what was cut (where; default: everywhere); return a Change."""
        return self._operate(
            "suture", _without_none(faces=faces, between=between, gap=gap, where=where))

    def remove_islands(self, below=None, *, outside=None, volume=None):
        """Remove whole pieces with fewer than `below` elements, with less `volume` at rest (m^3), or
        without a vertex in a box ({"box": {"min", "max"}}); return a Change."""
        return self._operate("remove_islands",
                             _without_none(below=below, outside=outside, volume=volume))

    # ---- tools ----

    @property
    def tools(self):
        """The obstacles of the scene by name, each a Tool with its force, its pose and
        move_to()."""
        from ._tools import Tools

        return Tools(self)

    # ---- models ----

    @property
    def parameters(self):
        """The parameters of the models, by the names of the models in the scene. Assigning to one,
        as in sim.parameters["organ"]["E"] = 2e4, changes it from now on."""
        from ._parameters import Parameters

        return Parameters(self)

    # ---- derivatives ----

    def adjoint(self, objective, tolerance=None, every_step=False, wrt=(), moments=False,
                then=None):
        """The derivative of an objective by everything that determines it: an Adjoint of this
        equilibrium, or a RunAdjoint of the run since keep_steps(). Raises InputError with the reason
        where there is none. See suture.gradient() for the other arguments. Of a run:

        moments  also keep the derivatives by loads and motions at each moment (loads, motions)
        then     the RunAdjoint of a simulation that went on from here, after a cut
        """
        from ._gradients import adjoint_of

        return adjoint_of(self, objective, tolerance, every_step, wrt, moments, then)

    def sensitivity(self, model, parameter, per=None, tolerance=1e-6):
        """The derivative of this equilibrium by a parameter of a model: a Sensitivity, whose cost
        is one linear solve per number. See Adjoint.gradient() for per."""
        from ._gradients import Sensitivity

        return Sensitivity(self, model, parameter, per, tolerance)

    # ---- callbacks ----

    def every(self, steps):
        """Decorator: call the function with the simulation after every `steps` steps.

        It may read everything and apply events, not make steps. An exception stops the run
        between two steps and reaches the caller; the simulation stays usable. Where the run rolls
        back to an earlier step, the function is called for the repeated steps, too.
        """
        if int(steps) != steps or steps < 1:
            raise ValueError(f"steps must be a whole number >= 1, is {steps!r}")

        def add(function):
            self._every(int(steps), function)
            return function

        return add

    def at(self, time):
        """Decorator: call the function once, before the first step that begins at or after
        `time` (s). The lengths of steps do not change."""

        def add(function):
            self._at(float(time), function)
            return function

        return add

    # ---- forces ----

    def force_term(self, function=None, *, energy=None, stiffness=None, name=None):
        """Decorator: a force on the vertices that the function computes.

            @sim.force_term(energy=lambda x, t: 5 * (x[:, 1] ** 2).sum())
            def pull(x, v, t, f):
                f[:, 1] -= 10 * x[:, 1]

        x, v       (n, 3) positions (m, relative to origin) and velocities (m/s)
        t          time, s
        f          (n, 3) forces in N, zero at first: add to it

        energy     function (x, t) that returns its energy in J; the force is then taken to be
                   conservative. Without it, its work is booked from the forces at both ends of
                   every step, under its name in energies().
        stiffness  bound on its stiffness per vertex, N/m, for the stable step; 0 for a force that
                   does not depend on the positions. Without it, the kernel finds the stiffness by
                   differences of the force: some 100 calls in every search of the stable step.
        name       default: that of the function

        The cost is one call per step, and two for each product with the tangent where the solver
        is implicit; sim.force_terms says how much was spent. The function must give the same force
        in the same state.
        """
        if stiffness is not None and not 0 <= stiffness < float("inf"):
            raise ValueError(f"stiffness must be finite and >= 0 N/m, is {stiffness!r}")

        def add(force):
            title = name or getattr(force, "__name__", "force")
            if title in self.energies():
                raise ValueError(f"energies() already has an entry {title!r}; give another name")
            self._terms.append(self._force_term(title, force, energy, stiffness))
            return force

        return add if function is None else add(function)

    @property
    def force_terms(self):
        """The ForceTerm objects of the force functions, with name, calls, seconds and work."""
        return tuple(self._terms)

    # ---- live view ----

    def live(self, *, port=0, host="", recording=True):
        """Serve a page that shows the simulation; return a Live with its address, which a notebook
        shows as the page.

        port       on this machine; 0: any that is free
        host       an address of this machine at which others may connect; "": none may
        recording  True, a path, or False: all that the script and the page have done since the
                   simulation was created, for `suture run`. It ends where a script assigns
                   positions or velocities, restores a state, cuts along arrays or adds a force
                   function, which nothing but the script can repeat.

        Needs Debian's libjs-three.
        """
        from ._live import Live

        if recording is True:
            recording = ""
        elif recording is False:
            recording = None
        return Live(self, port, host, recording)

    # ---- the body as it is now ----

    def mesh(self):
        """The elements that exist, at their current positions in the scene, as a Mesh of copies,
        with the named sets of the scene's mesh: both sides of a cut belong to the sets of what
        was cut.

        point_arrays["vertex"] and element_arrays["element"] hold the rows in the simulation's
        arrays; point_ids and element_ids there give your numbers.
        """
        import numpy

        from ._mesh import Mesh, without_unused

        points, cells, used = without_unused(self.position + self.origin, self._hexahedra())
        elements = numpy.flatnonzero(self.element_exists)
        point_sets, element_sets = (
            {name: numpy.searchsorted(rows, members) for name, members in sets.items()}
            for rows, sets in zip((used, elements), self._sets()))
        return Mesh(points, cells, point_sets, element_sets, point_arrays={"vertex": used},
                    element_arrays={"element": elements})

    def surface(self):
        """The boundary, cuts included, at the current positions: a Surface of copies. Of a body
        made from a surface, an EmbeddedSurface."""
        from ._mesh import without_unused

        embedded = self._embedded_surface()
        if embedded is None:
            quads, elements = self._boundary()
            return Surface(*without_unused(self.position + self.origin, quads), elements)
        triangles, elements, laid_open, cut, vertices, weights = embedded
        rows, triangles, used = without_unused(vertices, triangles)
        surface = EmbeddedSurface(None, triangles, rows, weights[used], elements, laid_open, cut)
        return surface._replace(points=surface.values(self.position + self.origin))

    def _fields(self, values_of, more):
        fields = {"displacement": values_of(self.position - self.rest),
                  "velocity": values_of(self.velocity)}
        for name, values in (more or {}).items():
            if len(values) != len(self.rest):
                raise ValueError(f"{name!r} must have one row per vertex, {len(self.rest)}; has "
                                 f"{len(values)}")
            fields[name] = values_of(values)
        return fields

    def to_vtk(self, fields=None):
        """A vtkUnstructuredGrid of the elements that exist, with displacement and velocity.

        fields  {name: values}, (vertices,) or (vertices, components), to add

        The arrays of mesh() become VTK's without another copy. Needs python3-vtk9.
        """
        from ._vtk import unstructured_grid

        mesh = self.mesh()
        rows = mesh.point_arrays["vertex"].astype(int)
        return unstructured_grid(
            mesh.points, mesh.hexahedra, self._fields(lambda values: values[rows], fields),
            {"element_id": self.element_ids[mesh.element_arrays["element"].astype(int)]})

    def picture(self, file=None, field="displacement", size=(800, 600), edges=True,
                direction=(1, 0.7, 2)):
        """Draw the surface as seen from `direction`, y up; return a Picture, which a notebook
        shows, and write it to a PNG file, if one is named. No display is needed.

        field  name of a field (fields()), an array of one row per vertex or element, or None:
               vectors are coloured by their magnitude

        Needs python3-matplotlib. Some 0.1 s for 20,000 faces.
        """
        from ._draw import draw_surface

        surface, name = self.surface(), "field"
        values = field
        if isinstance(field, str):
            name, values = field, self.field(field)
        picture = draw_surface(surface, values, name, len(self.rest), len(self.element_ids), size,
                               edges, direction, f"t = {self.time:.6g} s")
        if file is not None:
            picture.save(file)
        return picture

    def _repr_html_(self):
        """What a notebook shows: a line and a picture, if it can be drawn."""
        import html

        line = f"<pre>{html.escape(repr(self))}</pre>"
        try:
            return line + self.picture(size=(480, 360))._repr_html_()
        except (ImportError, RuntimeError):  # no matplotlib; it runs in another thread
            return line

    def record(self, steps, energies=True, **functions):
        """Record a row now and after every `steps` steps: energies(), and functions of the
        simulation by name, such as tip=lambda sim: sim.position[12]. Returns the Record, which
        has plot()."""
        from ._record import Record

        for name in functions:
            if name == "time" or (energies and name in self.energies()):
                raise ValueError(f"the record already has {name!r}; give another name")
        return Record(self, steps, energies, functions)
