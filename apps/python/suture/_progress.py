# SPDX-License-Identifier: GPL-3.0-or-later
"""A progress bar where tqdm is installed."""

import contextlib


@contextlib.contextmanager
def bar():
    """Yields a function (step, time, end), or None without tqdm."""
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(unit="s", bar_format="{l_bar}{bar}| {n:.4g}/{total:.4g} s") as shown:

        def update(step, time, end):
            shown.total = end or None
            shown.update(time - shown.n)

        yield update
