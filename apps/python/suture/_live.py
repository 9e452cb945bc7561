# SPDX-License-Identifier: GPL-3.0-or-later
"""The live view of a simulation in a browser or a notebook."""


class Live:
    """A page that shows a simulation, from Simulation.live().

    While the script makes steps, the page watches. run() gives it the control: play and pause,
    cuts, grasps. A notebook shows the page below the cell that made it.
    """

    def __init__(self, simulation, port, host, recording):
        self._simulation = simulation
        self._recording = None
        self.address = simulation._open_live(port, host, recording)
        """Open it in a browser on this machine. Who knows it controls the run."""

    def run(self, seconds=float("inf")):
        """Give the control to the page for so many seconds of real time, or until Ctrl-C (in a
        notebook: interrupt)."""
        if not seconds > 0:
            raise ValueError(f"seconds must be > 0, is {seconds!r}")
        self._require_open()
        try:
            self._simulation._run_live(float(seconds))
        except KeyboardInterrupt:
            pass

    @property
    def recording(self):
        """Path of the recording, which `suture run` repeats; None before the first input."""
        return self._simulation._live_recording() if self._recording is None else self._recording

    def close(self):
        """End the view and its recording."""
        if self._simulation is None:
            return
        self._recording = self.recording
        self._simulation._close_live()
        self._simulation = None

    def _require_open(self):
        if self._simulation is None:
            raise RuntimeError("this live view is closed; open another one: Simulation.live()")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        return f"<suture.Live {self.address if self._simulation else 'closed'}>"

    def _repr_html_(self):
        if self._simulation is None:
            return f"<code>{self!r}</code>".replace("<suture", "&lt;suture")
        return f'<iframe src="{self.address}" width="100%" height="600"></iframe>'
