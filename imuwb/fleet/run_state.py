"""``run.json``: what was run into a folder of results, and whether another run fits it."""

import json
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, get_args

from imuwb.errors import UsageError
from imuwb.fleet.own_files import RUN_JSON
from imuwb.fleet.schemas import SCHEMA
from imuwb.fleet.store import Store

State = Literal["running", "interrupted", "ended"]


@dataclass(frozen=True, slots=True)
class RunState:
    """What is in run.json; ``imuwb.fleet.schemas`` states the keys."""

    imuwb: str
    analysis: str
    params: dict[str, Any]
    command: str
    inputs: tuple[str, ...]
    executor: str
    run: str
    level: float | None = None
    state: State = "running"
    logs: int = 0
    done: int = 0
    quarantined: int = 0
    digest: str = ""  #: of all that the tables are made of; empty: they are not written
    tables: str = ""  #: hash of the bytes of the tables
    schema: int = SCHEMA

    def write(self, store: Store) -> None:
        """Write the file."""
        store.write(RUN_JSON, f"{json.dumps(asdict(self), indent=1, ensure_ascii=False)}\n".encode())


def run_state(store: Store, place: str, *, reading: bool = False) -> RunState | None:
    """Return what was run into a folder of results; None: nothing.

    Args:
        store: of the results.
        place: for messages.
        reading: whether the results are only read; messages then do not speak of options of a run.

    Raises:
        UsageError: the file is damaged, or of another version.
    """
    content = store.read(RUN_JSON)
    if content is None:
        return None
    where = f"{place.rstrip('/')}/{RUN_JSON}"
    try:
        known = json.loads(content)
        schema = known["schema"]
        if schema == SCHEMA:
            return _checked(
                RunState(**{f.name: known[f.name] for f in fields(RunState) if f.name in known or f.name != "tables"})
            )
    except (ValueError, KeyError, TypeError):
        remedy = (
            "run the fleet again into a new folder, or into this one with imuwb fleet ANALYSIS LOGS --force, which uses its parts"
            if reading
            else "give another folder, or --force to replace it"
        )
        raise UsageError(f"{where}: the file is damaged or of another program; {remedy}") from None
    remedy = (
        "run the fleet again into a new folder, or read the results with the version that wrote them"
        if reading
        else "give another folder, or --force to replace the tables; the parts of the other version stay"
    )
    raise UsageError(
        f"{where}: the results have the schema {str(schema)[:20]}, and this version of imuwb writes {SCHEMA}; {remedy}"
    )


def _checked(state: RunState) -> RunState:
    """Return a state whose values are of their types.

    Raises:
        TypeError: one is not.
    """
    kinds: dict[type, tuple[object, ...]] = {
        int: (state.logs, state.done, state.quarantined),
        str: (state.imuwb, state.analysis, state.command, state.executor, state.run, state.digest, state.tables),
        dict: (state.params,), list: (state.inputs,),
    }  # fmt: skip
    if any(type(one) is not kind for kind, own in kinds.items() for one in own) or state.state not in get_args(State):
        raise TypeError
    return state


def check_fits(own: RunState, known: RunState | None, place: str) -> None:
    """Raise UsageError if the results of a folder are those of another analysis, version or parameters."""
    nothing = known is None or (known.state != "ended" and not known.done)
    if known is None or nothing or known.run == own.run:
        return
    differs = {"analysis": (known.analysis, own.analysis), "version of imuwb": (known.imuwb, own.imuwb)}
    which = next(
        (f"{name}: {old}, not {new}" for name, (old, new) in differs.items() if old != new), "with other options"
    )
    raise UsageError(
        f"{place}: its results are of another run ({which}); give another folder, or --force to replace the tables; the parts of the other run "
        "stay, so that it can be made again at once"
    )
