"""From the options to the paper beside ours."""

from collections.abc import Sequence

import numpy as np

from imuwb import read
from imuwb.axes import axes_of
from imuwb.errors import MissingDataError
from imuwb.log import Log
from imuwb.progress import tracked
from imuwb.simulation import preset
from imuwb.stochastic import WhiteNoise
from imuwb.units import UNITS
from imuwb_plugins.reproduce.comparison import Found, Reproduction, compared, of_other_data
from imuwb_plugins.reproduce.hassaballa import sensor, settings
from imuwb_plugins.reproduce.parameters import Hassaballa
from imuwb_plugins.reproduce.printed import Key, paper

NAME, SENSOR = "hassaballa", "mpu-6050"
RATE = 1600.0  #: Hz, at which the noise before the sensor's low-pass is simulated
CLEAN = Key("2", "ARW", "200 Hz, 42 Hz")  #: the setting of table 2 without aliasing


def run(logs: Sequence[Log], parameters: Hassaballa) -> Reproduction:
    """Return the paper beside the simulations of all seeds, or beside the user's own record.

    Raises:
        MissingDataError: the user's record has no gyro z, or its rate is no multiple of 200 Hz.
        ImuwbError: it cannot be read.
    """
    del logs
    given = None if parameters.static is None else read(parameters.static)
    seeds = range(parameters.seed, parameters.seed + parameters.seeds)
    runs = [_run(given, parameters, seed) for seed in tracked(seeds, len(seeds))]
    still = f"{parameters.hours:g} h of a simulated {SENSOR}" if parameters.static is None else parameters.static.name
    data = f"{still}{f', {parameters.seeds} seeds' if parameters.seeds > 1 else ''}"
    reproduction = compared(paper(NAME), runs, data, simulated=given is None)
    return reproduction if given is None else of_other_data(reproduction, frozenset({"2"}))


def _run(given: Log | None, parameters: Hassaballa, seed: int) -> Found:
    model = preset(SENSOR)
    if given is None:
        printed = next(value for value in paper(NAME).values() if value.key == CLEAN)
        noise = WhiteNoise(UNITS[printed.unit].to_si(printed.value))
        n = round(parameters.hours * 3600 * RATE)
        found = settings.settings(noise.sample(n, 1 / RATE, np.random.default_rng(seed)), RATE, filtered=False)
    else:
        axes = axes_of(given.imu())
        if "gyro_z" not in axes:
            raise MissingDataError(f"{given.provenance.path}: {given.imu().name} has no gyro z, which table 2 is of")
        found = settings.settings(axes["gyro_z"].longest, 1 / axes["gyro_z"].clock.interval, filtered=True)
    values = {**settings.table(found), **dict(sensor.data_sheet(model, min(parameters.hours, 1.0), seed))}
    return Found(values, {**settings.figures(found), **dict(sensor.figures(model, seed))})
