# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes from Python values: what the kernel reads is always one JSON text."""

import json
import math
import os
from collections.abc import Mapping


def _plain(value):
    """numpy's arrays and numbers as JSON; paths as strings."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a scene cannot contain {type(value).__name__} ({value!r})")


def _not_finite(value, pointer=""):
    """The JSON pointer of the first number that is not finite; None without any."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return None if math.isfinite(value) else pointer
    if isinstance(value, Mapping):
        parts = value.items()
    else:
        parts = enumerate(value) if isinstance(value, (list, tuple)) else ()
    found = (_not_finite(part, f"{pointer}/{key}") for key, part in parts)
    return next((place for place in found if place is not None), None)


def to_json(value, **options):
    try:
        return json.dumps(value, default=_plain, allow_nan=False, **options)
    except ValueError as error:
        if "Out of range" not in str(error):
            raise
        raise ValueError(f"{_not_finite(value) or 'the value'}: must be a finite number") from None


def set_texts(values):
    """{"/solver/dt": 1e-4} as the texts of --set."""
    if values is None:
        return []
    if not isinstance(values, Mapping):
        raise TypeError(
            "set must be a dict of JSON pointers and values, such as {'/solver/dt': 1e-4}; "
            f"is {type(values).__name__}"
        )
    return [f"{pointer}={to_json(value)}" for pointer, value in values.items()]


def is_text(scene):
    """A text is JSON; anything else that is a string is the path of a file."""
    return isinstance(scene, str) and (scene.lstrip()[:1] == "{" or "\n" in scene)


def source_of(scene, folder):
    """(text, file, is_text): what the kernel reads, and the name of it in messages."""
    if isinstance(scene, Mapping):
        return to_json(scene, indent=1), os.path.join(folder or "", "scene"), True
    if is_text(scene):
        return scene, os.path.join(folder or "", "scene"), True
    if isinstance(scene, (str, os.PathLike)):
        if folder is not None:
            raise TypeError("folder is only allowed with a scene from a dict or a text; "
                            "files are relative to the folder of the scene file")
        return "", os.fspath(scene), False
    raise TypeError(
        "a scene is a path, a dict or a JSON text; is " + type(scene).__name__
    )
