"""How an analysis is run: the number of its logs, and errors in its own code."""

import errno
from pathlib import Path
from types import SimpleNamespace

import pytest

from imuwb.cli.perform import check_count, errors_named
from imuwb.errors import ImuwbError, MissingDataError, UsageError


@pytest.mark.parametrize(
    ("logs", "count", "wanted"),
    [(None, 0, "1 log;"), (None, 2, "1 log;"), ((2, 3), 1, "2 to 3 logs"), ((2, 3), 4, "2 to 3 logs"), ((2, None), 1, "2 or more logs")],
)  # fmt: skip
def test_too_few_and_too_many_logs_are_wrong_usage(logs, count, wanted):
    analysis = SimpleNamespace() if logs is None else SimpleNamespace(LOGS=logs)
    with pytest.raises(UsageError, match=f"{wanted}.*{count} are given"):
        check_count("mine", analysis, [Path("a.csv")] * count)


@pytest.mark.parametrize(("logs", "count"), [((1, 1), 1), ((2, 3), 2), ((2, 3), 3), ((2, None), 99)])
def test_the_declared_number_of_logs_is_taken(logs, count):
    check_count("mine", SimpleNamespace(LOGS=logs), [Path("a.csv")] * count)


def test_an_error_in_a_plugin_names_the_plugin_and_errors_of_imuwb_stay():
    analysis = SimpleNamespace(__file__=__file__)
    line = "analysis mine failed: ZeroDivisionError.*test_perform.py, line"
    with pytest.raises(ImuwbError, match=line), errors_named("mine", analysis):
        1 / 0  # noqa: B018 - this fails on purpose
    with pytest.raises(MissingDataError), errors_named("mine", analysis):
        raise MissingDataError
    with (
        pytest.raises(MemoryError),
        errors_named("mine", analysis),
    ):  # the command line says what to do, as of a reader's
        raise MemoryError
    with (
        pytest.raises(OSError, match="open files"),
        errors_named("mine", analysis),
    ):  # of the machine, not of the plugin
        raise OSError(errno.EMFILE, "too many open files")
    with pytest.raises(ImuwbError, match="outside its own code"), errors_named("mine", SimpleNamespace(__file__="")):
        raise ValueError
