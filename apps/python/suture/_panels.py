# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of a picture: curves with a legend or a scale of colours."""

import sys
from typing import NamedTuple

import numpy

from ._results import TIME

MOST_PANELS = 24
MOST_LABELS = 12  # in a legend


class Scale(NamedTuple):
    """Colours for the values of a parameter."""

    label: str
    low: float
    high: float
    is_log: bool

    def mappable(self):
        from matplotlib import cm, colors

        norm = (colors.LogNorm if self.is_log else colors.Normalize)(self.low, self.high)
        return cm.ScalarMappable(norm, "viridis")


class Curve(NamedTuple):
    label: str
    x: numpy.ndarray
    y: numpy.ndarray
    value: float = 0.0
    """Where it lies on the panel's scale."""


class Panel(NamedTuple):
    title: str
    curves: list
    x_label: str = TIME
    scale: Scale = None
    """Instead of a legend."""
    has_legend: bool = True
    has_marks: bool = False
    is_log: bool = False
    """True if the axis of x is logarithmic."""
    ticks: list = None
    """Names of x = 0, 1, 2, ..."""


def is_logarithmic(values):
    """Whether positive numbers are better seen on a logarithmic axis."""
    return values.min() > 0 and values.max() / values.min() > 30


def is_chosen(name, only):
    """Whether a column is one of those that the user asked for; without `only`, all are."""
    return not only or any(text.lower() in name.lower() for text in only)


def draw_panel(axes, panel):
    colours = panel.scale and panel.scale.mappable()
    for curve in panel.curves:
        marks = "o" if panel.has_marks or len(curve.x) == 1 else ""
        axes.plot(curve.x, curve.y, lw=1, marker=marks, ms=3, label=curve.label,
                  color=colours.to_rgba(curve.value) if colours else None)
    axes.set_title(panel.title)
    axes.set_xlabel(panel.x_label)
    axes.grid(alpha=0.3)
    if panel.is_log:
        axes.set_xscale("log")
    if panel.ticks:
        axes.set_xticks(range(len(panel.ticks)), panel.ticks)
    if colours:
        axes.figure.colorbar(colours, ax=axes, label=panel.scale.label)
    elif panel.has_legend and len(panel.curves) <= MOST_LABELS:
        axes.legend(fontsize=7, loc="best")


def limited(panels):
    """The first of them, with a note if there are too many for one picture."""
    if len(panels) > MOST_PANELS:
        print(f"suture: {MOST_PANELS} of {len(panels)} columns are drawn; choose others with "
              "--only TEXT", file=sys.stderr)
    return panels[:MOST_PANELS]
