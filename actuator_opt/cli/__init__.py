"""The command line: read arguments, call the library, print. It contains no physics."""

try:
    from .app import command_line, main
except KeyboardInterrupt:  # set before any command that could be interrupted
    import sys

    print("interrupted", file=sys.stderr)
    sys.exit(130)

__all__ = ["command_line", "main"]
