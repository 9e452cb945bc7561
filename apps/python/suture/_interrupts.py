# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C where processes are forked. It may come at any instruction of Python: within a fork, it
would leave a traceback, a process that nobody ends, or nothing at all."""

import contextlib
import signal
import threading


@contextlib.contextmanager
def delayed():
    """Around the start of a process: Ctrl-C takes effect at the end of the block."""
    handler = signal.getsignal(signal.SIGINT)
    # It does not come to other threads, and may be ignored.
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    came = []
    signal.signal(signal.SIGINT, lambda *_: came.append(True))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if came:
            handler(signal.SIGINT, None)


@contextlib.contextmanager
def taken():
    """In a process started so: Ctrl-C takes effect from here to the end of the block only."""
    if callable(signal.getsignal(signal.SIGINT)):
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
