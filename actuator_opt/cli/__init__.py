"""The command line: read arguments, call the library, print. It contains no physics."""

import os

for library in ("OPENBLAS", "OMP", "MKL"):
    # Threads that wait for each other take twelve times as long on systems as small as ours; this
    # must precede the import of NumPy.
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

try:
    from .app import command_line, main
except KeyboardInterrupt:  # set before any command that could be interrupted
    import sys

    print("interrupted", file=sys.stderr)
    sys.exit(130)

__all__ = ["command_line", "main"]
