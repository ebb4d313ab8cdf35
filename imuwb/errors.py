"""The errors of imuwb, and their exit codes on the command line.

ImuwbError                 1  the work failed, for example because a file cannot be written
 ├── UsageError            2  a command, option, parameter or plugin is wrong
 ├── MissingDataError      3  the log is sound but lacks what the analysis needs
 └── UnreadableLogError    4  the log cannot be read, or contradicts its stated units

A message names the value, the rule that the value breaks, and the remedy.
"""


class ImuwbError(Exception):
    """Base of all errors that imuwb raises on purpose."""

    exit_code = 1


class UsageError(ImuwbError):
    """A command, option, parameter or plugin is wrong."""

    exit_code = 2


class MissingDataError(ImuwbError):
    """The log is sound but lacks the data that the analysis needs."""

    exit_code = 3


class UnreadableLogError(ImuwbError):
    """The file is not a readable log, or contradicts its stated units."""

    exit_code = 4
