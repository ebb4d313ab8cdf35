"""run.json is read as it was written, whatever the parameters of the analysis are."""

import pytest

from imuwb.fleet.run_state import RunState, run_state
from imuwb.fleet.store import FolderStore


@pytest.mark.parametrize("level", [None, 0.95, 95, "strict"])
def test_a_state_is_read_as_it_was_written(tmp_path, level):
    state = RunState("1", "mine", {"level": level}, "imuwb fleet mine", ("logs",), "this process", "r", level)
    store = FolderStore(tmp_path)
    state.write(store)
    read = run_state(store, "results", reading=True)
    assert (read.params, read.level, tuple(read.inputs)) == (state.params, level, state.inputs)
