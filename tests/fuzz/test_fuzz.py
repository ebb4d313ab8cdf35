"""Damaged and hostile logs end soon, in a log or in an error of ours; README.md beside this file has the figures of a long run."""

import multiprocessing

import pytest

from imuwb.errors import ImuwbError
from imuwb.readers import ReadOptions, read
from tests.fuzz.bombs import BOMBS, LARGE
from tests.fuzz.containers import CONTAINERS, container_of
from tests.fuzz.harness import LONGEST, MOST, alone, tallied
from tests.fuzz.seeds import write

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="workers are forked"),
]
SHORT = 20  #: damaged logs of each sound one


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    return write(tmp_path_factory.mktemp("seeds"))


def test_damaged_logs_are_read_or_refused(logs):
    tally = tallied(logs, range(SHORT))
    assert not tally.faults, "\n".join(f"{name} {seed}: {what}" for name, seed, what in tally.faults)
    assert set(tally.read) == set(logs)
    assert 0.2 < tally.sound / tally.read.total() < 0.95  # some are read, and some are refused
    assert tally.spoilt > 5
    assert tally.prefixes > 5


def test_a_sound_log_is_the_same_together_as_before(logs, tmp_path):
    for name, data in logs.items():
        container = container_of(name)
        if container is None or name.endswith(".toml"):
            continue
        for kind, content in (("before", data), ("after", container.together(container.apart(data)))):
            (tmp_path / kind).mkdir(exist_ok=True)
            (tmp_path / kind / name).write_bytes(content)
            (tmp_path / kind / "stated.toml").write_bytes(logs["stated.toml"])
        before, after = (read(tmp_path / kind / name) for kind in ("before", "after"))
        assert [str(s) for s in after.imus] == [str(s) for s in before.imus]
        assert len(after.gnss) == len(before.gnss)
    assert {".mcap", ".bag", ".ulg", ".tlog", ".ubx", ".nmea", ".gps", ".csv"} < CONTAINERS.keys()


@pytest.mark.parametrize("name", BOMBS)
def test_a_log_that_states_much_ends_soon(name, tmp_path):
    path = BOMBS[name](tmp_path)

    def work():
        try:
            read(path)
        except ImuwbError as error:
            assert len(str(error)) < 4000  # noqa: PT017 - another error is a fault

    what, seconds, size = alone(work)
    assert not what
    assert seconds < LONGEST
    assert size < MOST


@pytest.mark.parametrize("name", LARGE)
def test_a_log_that_unpacks_to_much_is_read_in_proportion(name, tmp_path):
    path = LARGE[name](tmp_path)

    def work():
        with pytest.raises(ImuwbError):
            read(path)

    what, _, size = alone(work, seconds=30.0)
    assert not what
    assert size < MOST


def test_more_memory_may_be_allowed(tmp_path):
    path = BOMBS["large_chunks"](tmp_path)
    with pytest.raises(ImuwbError, match="--memory"):
        read(path)

    def work():
        with pytest.raises(ImuwbError, match="no message"):
            read(path, ReadOptions(memory=1.5))

    what, _, _ = alone(work, seconds=30.0, most=2 * MOST)
    assert not what
