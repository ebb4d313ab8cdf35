"""From the options to the paper beside ours."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from imuwb import read
from imuwb.log import Log
from imuwb.progress import tracked
from imuwb.replay import of_static, with_autoregressive
from imuwb.simulation import drive, planned_route, preset, static
from imuwb.stochastic import ImuErrorModel
from imuwb_plugins.noise.compute import run as noise
from imuwb_plugins.noise.model import error_model
from imuwb_plugins.noise.parameters import Parameters as NoiseParameters
from imuwb_plugins.reproduce.comparison import Found, Reproduction, compared, of_other_data
from imuwb_plugins.reproduce.parameters import Quinchia
from imuwb_plugins.reproduce.printed import paper
from imuwb_plugins.reproduce.quinchia import bench, figures, road

SENSOR = "3dm-gx3-25"  #: the preset of table 4
RATE = 100.0  #: Hz
NAME = "quinchia"


def run(logs: Sequence[Log], parameters: Quinchia) -> Reproduction:
    """Return the paper beside the simulations of all seeds, or beside the user's own records.

    Raises:
        MissingDataError: a log of the user's own lacks what the tables need.
        ImuwbError: it cannot be read.
    """
    del logs
    seeds = range(parameters.seed, parameters.seed + parameters.seeds)
    runs = [_run(parameters, seed) for seed in tracked(seeds, len(seeds))]
    reproduction = compared(paper(NAME), runs, _data(parameters), simulated=parameters.static is None)
    return of_other_data(reproduction, _others(parameters)) if parameters.static is not None else reproduction


def _run(parameters: Quinchia, seed: int) -> Found:
    steps = tracked(range(4), 4)
    next(steps)
    model = preset(SENSOR)
    if parameters.static is None:
        still = static(model, parameters.hours * 3600, RATE, seed)
        found = bench.still(still)
    else:
        still = read(parameters.static)
        found = bench.still(still)
        model = error_model(noise([still], NoiseParameters()))
    next(steps)
    logs = [read(path) for path in parameters.drive] or [drive(model, planned_route(r), seed) for r in road.ROUTES]
    plans = road.plans(logs, simulated=not parameters.drive)
    next(steps)
    driven = list(_driven(logs, plans, with_autoregressive(model, of_static(still.imu())[0])))
    missing = {
        value.key: "the drive has no such outage" for table in paper(NAME).tables for value in table.values
        if value.key.table in ("6", "7", "8", "9", "10", "section 7")
    }  # fmt: skip
    next(steps)
    return replace(
        found,
        values={**missing, **found.values, **road.tables(driven)},
        figures={**found.figures, **figures.drawn(driven)},
    )


def _driven(logs: Sequence[Log], plans: Sequence[road.Plan], model: ImuErrorModel) -> Iterator[road.Driven]:
    for log, plan in tracked(list(zip(logs, plans, strict=True)), len(logs)):
        yield road.driven(log, plan, model)


def _data(parameters: Quinchia) -> str:
    """Return what ours is of."""
    still = parameters.static.name if parameters.static else f"{parameters.hours:g} h of a simulated {SENSOR}"
    drives = ", ".join(path.name for path in parameters.drive) or "two simulated drives"
    seeds = f", {parameters.seeds} seeds" if parameters.seeds > 1 else ""
    return f"{still}, {drives}{seeds}"


def _others(parameters: Quinchia) -> frozenset[str]:
    """Return the tables that are of the user's own logs."""
    tables = {"2", "3", "4", "5"}
    return frozenset(tables | {"6", "7", "9", "10", "section 7"} if parameters.drive else tables)
