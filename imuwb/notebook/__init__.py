"""Analyses in a notebook or a program: ``imuwb.run("noise", "static.mcap")`` does what the command line does, and writes nothing."""

from imuwb.notebook.outcome import Outcome
from imuwb.notebook.run import run
from imuwb.notebook.shown import Picture, TableFrame

__all__ = ["Outcome", "Picture", "TableFrame", "run"]
