"""The errors of imuwb, and the exit code of each kind on the command line.

::

    ImuwbError                 1  the work failed: a file cannot be written, no viewer runs, ...
     ├── UsageError            2  a command, an option or a plugin is wrong
     ├── MissingDataError      3  the log is sound, but lacks data that the analysis needs
     └── UnreadableLogError    4  the log cannot be read, or contradicts what its user states
          └── TransferError    4  a network or a store failed while the log was read; another attempt may succeed

A message names the value, the rule that it breaks, and what to do.
"""


class ImuwbError(Exception):
    """Base of every error that imuwb raises on purpose."""

    exit_code = 1


class UsageError(ImuwbError):
    """A command, option, parameter or plugin is wrong."""

    exit_code = 2


class MissingDataError(ImuwbError):
    """The log is sound, but lacks data that the analysis needs."""

    exit_code = 3


class UnreadableLogError(ImuwbError):
    """The log cannot be read, or contradicts what its user states."""

    exit_code = 4


class TransferError(UnreadableLogError):
    """A network or a store failed while the log was read; another attempt may succeed."""
