"""``python -m imuwb``."""

from imuwb.cli import program

program()
