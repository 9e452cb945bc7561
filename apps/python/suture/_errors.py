# SPDX-License-Identifier: GPL-3.0-or-later
"""How the commands written in Python end with an error, as those of the program do."""

import sys


def report_error(error):
    """Prints the message; returns the exit code, which is never that of a difference (1)."""
    from . import Error

    if isinstance(error, OSError):
        has_name = error.filename is not None and error.strerror
        text, code = f"{error.filename}: {error.strerror}" if has_name else str(error), 6
    elif isinstance(error, (Error, ValueError, ImportError)):
        text, code = str(error), 3
    else:
        text, code = (f"unexpected: {type(error).__name__}: {error}; this is a bug in Suture, "
                      "please report it"), 6
    print(f"suture: error: {text}", file=sys.stderr)
    return code


def exit_code_of_study(main, work):
    """Calls main(), which the same command continues if it is stopped, and reports its error."""
    try:
        return main()
    except KeyboardInterrupt:
        print(f"suture: stopped; the same command continues the {work}", file=sys.stderr)
        return 130
    except Exception as error:
        return report_error(error)
