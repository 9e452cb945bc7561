# SPDX-License-Identifier: GPL-3.0-or-later
"""Time series of a run in memory."""

import numpy


class Record:
    """What Simulation.record() gathers: one row now, and one every few steps.

    record.time          (rows,) s
    record["kinetic"]    (rows,) or (rows, ...) of an energy or of a function of yours
    """

    def __init__(self, simulation, steps, energies, functions):
        self._energies = energies
        self._functions = functions
        self._rows = []
        self._take(simulation)
        simulation.every(steps)(self._take)

    def _take(self, simulation):
        row = {"time": simulation.time}
        if self._energies:
            row.update(simulation.energies())
        for name, function in self._functions.items():
            row[name] = numpy.array(function(simulation), float)
        while self._rows and self._rows[-1]["time"] >= row["time"]:
            self._rows.pop()  # of steps that were rolled back
        self._rows.append(row)

    def __len__(self):
        return len(self._rows)

    def __getitem__(self, name):
        if name not in self._rows[-1]:
            raise KeyError(f"the record has no {name!r}; it has {', '.join(self.names)}")
        # The work of a force term begins with the term.
        return numpy.array([row.get(name, 0.0) for row in self._rows])

    @property
    def names(self):
        return list(self._rows[-1])

    @property
    def time(self):
        return self["time"]

    def plot(self, *names, ax=None):
        """Plot series over time with matplotlib: those named, or what you recorded, or all
        energies. Returns the axes."""
        if ax is None:
            import matplotlib.pyplot

            ax = matplotlib.pyplot.figure().add_subplot()
        for name in names or self._functions or [n for n in self.names if n != "time"]:
            values = self[name]
            if values.ndim == 1:
                ax.plot(self.time, values, label=name)
                continue
            for i, part in enumerate(values.reshape(len(values), -1).T):
                ax.plot(self.time, part, label=f"{name} {'xyz'[i] if values.shape[1] == 3 else i}")
        ax.set_xlabel("time [s]")
        if not names and not self._functions:
            ax.set_ylabel("energy [J]")
        ax.legend()
        return ax
