"""The logs that plugins are tested on: small, simulated, and the same in every run."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from imuwb.log import Log, Triad
from imuwb.simulation import Temperature, drive, mixed_route, preset, six_position, static
from imuwb.stochastic import ImuErrorModel
from imuwb.texts import name_of

SENSOR = "adis16465"  #: published sensor whose noise the logs have
RATE = 50.0  #: Hz
STILL, DRIVEN, TURNED = 60.0, 90.0, 5.0  #: s: the still log, the drive, and each position
POSITIONS = 12
CELSIUS = Temperature(((0.0, 20.0), (STILL, 30.0)))
#: what people and attackers write into names: escapes of a terminal, Markdown, HTML, marks that turn the direction of a text
HOSTILE = (
    "/imu\x1b]52;c;aGVsbG8=\x07\x1b[2J",
    "/a\n\n# HEAD\n|x|y|\n|-|-|\n![p](http://127.0.0.1:9/p.png)[l](file:///etc/passwd)```\n",
    '/b"><img src=http://127.0.0.1:9/q.png><script>fetch("http://127.0.0.1:9/")</script>',
    "/c\u202egpj.exe\u200b\u2066",
)


def model() -> ImuErrorModel:
    """Return the error model of the sensor of the logs."""
    return preset(SENSOR)


@cache
def still() -> Log:
    """Return a minute of a still sensor that warms by 10 °C."""
    return static(model(), STILL, RATE, 1, celsius=CELSIUS)


@cache
def driven() -> Log:
    """Return a drive of a minute and a half with GNSS fixes and the truth."""
    return drive(model(), mixed_route(DRIVEN, 0), 1, rate=RATE)


@cache
def turned() -> Log:
    """Return a sensor that is still in twelve positions, one after the other."""
    made = six_position(model(), 1, positions=POSITIONS, seconds=TURNED, rate=RATE, one_log=True)
    return next(iter(made.logs.values()))


def empty() -> Log:
    """Return a log without any stream, as of a file that has only its header."""
    return replace(still(), imus=(), notes=("the file has no rows",))


def one_axis(log: Log) -> Log:
    """Return a log whose first IMU is a single gyro about its z axis: the other axes are nan, and there is no accelerometer."""
    imu = log.imus[0]
    rate = imu.angular_rate
    if rate is None:
        return log
    value = np.full(rate.value.shape, np.nan)
    value[:, 2] = rate.value[:, 2]
    return replace(log, imus=(replace(imu, angular_rate=Triad(rate.time, value), specific_force=None), *log.imus[1:]))


def lacking(log: Log) -> dict[str, Log]:
    """Return the logs that lack data, by what they have."""
    return {"a log without streams": empty(), "a single gyro": one_axis(log)}


def hostile(log: Log) -> Log:
    """Return a log whose names and path have hostile words, as a reader of imuwb passes them on."""
    names = [name_of(text) for text in HOSTILE]
    imus = tuple(replace(imu, name=names[i % len(names)]) for i, imu in enumerate(log.imus))
    gnss = tuple(replace(one, name=names[-1 - i % len(names)]) for i, one in enumerate(log.gnss))
    references = tuple(replace(one, name=names[1]) for one in log.references)
    path = str(Path(name_of("a\x1b[2J![p](http:).mcap")))
    return replace(log, provenance=replace(log.provenance, path=path), imus=imus, gnss=gnss, references=references)


def changed_after(log: Log, share: float) -> tuple[Log, int]:
    """Return a log whose IMUs measure something else from a share of its duration on, and the time (ns) of the first change."""
    time = [t.time for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None and len(t)]
    begin, end = min(int(t[0]) for t in time), max(int(t[-1]) for t in time)
    moment = begin + round(share * (end - begin))
    rng = np.random.default_rng(7)

    def changed(triad: Triad | None) -> Triad | None:
        if triad is None or not len(triad):
            return triad
        late = triad.time >= moment
        value = triad.value.copy()
        spread = np.nanstd(triad.value) + 1.0
        value[late] += spread * (1.0 + rng.standard_normal(value[late].shape))
        return Triad(triad.time, value)

    imus = tuple(
        replace(imu, angular_rate=changed(imu.angular_rate), specific_force=changed(imu.specific_force))
        for imu in log.imus
    )
    return replace(log, imus=imus), moment


def fingerprint(log: Log) -> tuple[bytes, ...]:
    """Return the bytes of all samples of the IMUs of a log."""
    triads = [t for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None]
    return tuple(part.tobytes() for t in triads for part in (t.time, t.value))
