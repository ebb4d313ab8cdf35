"""What can go wrong, and the exit code each kind has on the command line.

ImuwbError                 1  the work failed (a file cannot be written, a viewer is gone)
 ├── UsageError            2  the command, an option or a plugin is not as it must be
 ├── MissingDataError      3  the log is sound, but has not what the analysis needs
 └── UnreadableLogError    4  the log cannot be read, or contradicts what is said of it

A message names the value, the rule it breaks, and what to do about it.
"""


class ImuwbError(Exception):
    """Base of every error that imuwb raises on purpose."""

    exit_code = 1


class UsageError(ImuwbError):
    """A command, option, parameter or plugin is not as it must be."""

    exit_code = 2


class MissingDataError(ImuwbError):
    """The log is sound, but holds too little or not the right kind of data."""

    exit_code = 3


class UnreadableLogError(ImuwbError):
    """The bytes are not a log that can be read, or contradict what is said of them."""

    exit_code = 4
