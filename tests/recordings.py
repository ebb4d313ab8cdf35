"""Real recordings and published figures, which are not part of the repository.

The environment variable IMUWB_RECORDINGS names their folder; without it, ``../shared`` beside the repository is taken. Tests
that compare with them (parity tests) skip where the folder is absent, and the last lines of a run say how many did and why.
With IMUWB_REQUIRE_RECORDINGS a run fails when the folder is there and a parity test is skipped all the same.
"""

import os
from collections import Counter
from pathlib import Path

import pytest

FOLDER = Path(os.environ.get("IMUWB_RECORDINGS") or Path(__file__).resolve().parents[2] / "shared")
PARITY = "parity: "  #: begins the reason of each skip for want of a recording


def recording(*parts: str) -> Path:
    """Return a file or folder of the recordings; the test is skipped where it is absent."""
    path = FOLDER.joinpath(*parts)
    if not path.exists():
        missing = path if FOLDER.is_dir() else f"{FOLDER} (IMUWB_RECORDINGS names another folder)"
        pytest.skip(f"{PARITY}{missing} is not there")
    return path


@pytest.fixture(scope="session")
def shared():
    """Return the folder of real recordings."""
    return recording("data")


@pytest.fixture(scope="session")
def papers():
    """Return the folder of the papers' published figures."""
    return recording("papers")


def _skipped(config):
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    skips = [] if reporter is None else reporter.stats.get("skipped", [])
    reasons = [report.longrepr[2].removeprefix("Skipped: ") for report in skips if isinstance(report.longrepr, tuple)]
    return Counter(reason.removeprefix(PARITY) for reason in reasons if reason.startswith(PARITY))


def pytest_sessionfinish(session):
    if os.environ.get("IMUWB_REQUIRE_RECORDINGS") and FOLDER.is_dir() and _skipped(session.config):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter, config):
    skips = _skipped(config)
    if skips:
        terminalreporter.write_line(f"{skips.total()} parity tests were skipped:")
        for reason, count in skips.most_common():
            terminalreporter.write_line(f"  {count}: {reason}")
