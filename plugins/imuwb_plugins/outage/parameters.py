"""What can be asked of an outage replay."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path  # noqa: TC003 - the command line reads the annotations as the program runs
from typing import Annotated, Literal

OWN = "own"
ALL = "none,15AV,18AV,18AVWD,15AR,27AR,full"
FARTHEST, LONGEST_ARM = 10.0, 500.0  #: s, m
DEEPEST = 12  #: level of denoising
SHORTEST, LONGEST = 2.0, 600.0  #: s, of an outage


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb outage``."""

    error_model: Annotated[Path | None, "the IMU's error model, TOML: from imuwb noise, or written by hand"] = None
    models: Annotated[str, "filters to compare, by name"] = ALL
    wavelet: Annotated[
        str, "levels of denoising to try besides, as 3..8 or 4,6: 18AVWD at each, for the choice; else table 7's"
    ] = ""
    durations: Annotated[str, "s, of a sweep's outages"] = "30,60"
    at: Annotated[
        str, "outages to run, as START:DURATION,... in s from the log's start; else a sweep of all starts"
    ] = ""
    random: Annotated[int, "so many starts of a sweep, drawn at random; 0: all"] = 0
    seed: Annotated[int, "of --random"] = 0
    reference: Annotated[
        Literal["best", "truth", "fixed", "smoothed", "own"],
        "what drift is measured against: the log's truth, RTK-fixed points, all fixes smoothed, a filter's own run, or the best there is",
    ] = "best"
    filter: Annotated[Path | None, "a filter of --save-filter, run besides; its settings hold for all"] = None
    save_filter: Annotated[Path | None, "write the last filter, as TOML"] = None
    degrade: Annotated[str, "make fixes worse, as noise=M,jump=M,every=S: added noise and jumps"] = ""
    reading: Annotated[
        Literal["corrected", "as-printed"], "of Quinchia's formulas: what they mean, or what they say"
    ] = "corrected"
    receiver: Annotated[str | None, "which GNSS receiver, by its name in imuwb info"] = None
    mounting: Annotated[
        str, "deg; roll,pitch,heading that turn vectors from the vehicle's axes to the IMU's; auto estimates them"
    ] = "0,0,0"
    lever_arm: Annotated[str, "m; forward,right,down from the IMU to the antenna"] = "0,0,0"
    gnss_delay: Annotated[str, "s by which a fix's stamp is later than what it shows; auto estimates it"] = "0"
    velocity_delay: Annotated[
        float, "s by which a fix's velocity is older than its position; auto delays estimate it"
    ] = 0.0
    clock_rate: Annotated[str, "true seconds in one of the IMU's; auto estimates it, with the delay"] = "1"
    skew: Annotated[float, "s by which the accelerometer's stamps are later than the gyro's"] = 0.0
    scale_factor: Annotated[str, "sigmas of scale factors as GYRO,ACCEL in %, 0: no state"] = "0,0"
    tune: Annotated[bool, "fit the noise to outages of the first half of the log, and judge it on the second"] = False
    turn_on: Annotated[
        str, "sigmas of turn-on biases as GYRO,ACCEL in deg/s and m/s² for every filter; auto: only full has them"
    ] = "auto"
    settling: Annotated[float, "s of fixes before the first outage"] = 60.0
    every: Annotated[int, "samples between two covariances"] = 10
    straight: Annotated[float, "m/s; sigma of no slip across and down, 0: off (non-holonomic constraint)"] = 0.0
    still: Annotated[float, "m/s; sigma of no velocity while standing, 0: off (zero-velocity update)"] = 0.0
    speed: Annotated[float, "m/s; sigma of the log's own forward speed, 0: off (odometer)"] = 0.0
    map: Annotated[bool, "also draw tracks on a map, which the viewer fetches from the network"] = False
    navigation: Annotated[
        Path | None, "also write the last filter's solution with all fixes: .csv, .tum, .kml or .mcap"
    ] = None
    level: Annotated[float, "of all intervals"] = 0.95

    def __post_init__(self) -> None:
        """Check the texts."""
        if not 0.5 <= self.level < 1:  # noqa: PLR2004 - an interval at even odds is none
            message = f"level is {self.level}; it must be at least 0.5 and below 1"
            raise ValueError(message)
        for name in ("straight", "still", "speed", "settling"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0):
                message = f"{name} is {value}; it must be 0 or more"
                raise ValueError(message)
        for name, largest in (("velocity_delay", 10.0), ("skew", 1.0)):
            value = getattr(self, name)
            if not (math.isfinite(value) and abs(value) <= largest):
                message = f"{name} is {value} s; it must be within {largest:g} s of 0"
                raise ValueError(message)
        if self.at.strip() and not self.outages() and self.at != OWN:
            message = f"at is {self.at!r}; write START:DURATION,... such as 200:30,430:60"
            raise ValueError(message)
        if not 1 <= self.every <= 100:  # noqa: PLR2004 - a second of most IMUs
            message = f"every is {self.every} samples; it must be 1 to 100"
            raise ValueError(message)
        if self.random < 0:
            message = f"random is {self.random} starts; it must be 0 or more"
            raise ValueError(message)
        self.names()
        self.levels()
        self.outages()
        self.lengths()
        self.angles()
        self.lever()
        self.delay()
        self.rate()
        self.degradation()
        self.scale_factors()
        self.turn_on_sigmas()

    def names(self) -> tuple[str, ...]:
        """Return the filters' names."""
        found = tuple(part.strip() for part in self.models.split(",") if part.strip())
        unknown = [name for name in found if name not in ALL.split(",")]
        if unknown or not found or len(set(found)) < len(found):
            what = f"no filter {unknown[0]!r}" if unknown else ("one is named twice" if found else "none is named")
            message = f"models: {what}; there are {ALL}"
            raise ValueError(message)
        return found

    def levels(self) -> tuple[int, ...]:
        """Return the levels of denoising to try."""
        first, mark, last = self.wavelet.partition("..")
        texts = [t.strip() for t in self.wavelet.split(",")] if not mark else [first.strip(), last.strip()]
        if not self.wavelet:
            return ()
        if not all(t.isdecimal() and 1 <= int(t) <= DEEPEST for t in texts) or (mark and int(first) > int(last)):
            message = f"wavelet is {self.wavelet!r}; write levels from 1 to {DEEPEST}, as 3..8 or 4,6"
            raise ValueError(message)
        return tuple(range(int(first), int(last) + 1)) if mark else tuple(dict.fromkeys(int(t) for t in texts))

    def lengths(self) -> tuple[float, ...]:
        """Return the durations of a sweep, s."""
        found = _numbers("durations", self.durations)
        _check_lengths("durations", found)
        return tuple(sorted(set(found)))

    def outages(self) -> tuple[tuple[float, float], ...]:
        """Return (start, duration) of explicit outages, s."""
        found: list[tuple[float, float]] = []
        if self.at == OWN:
            return ()
        for part in [p.strip() for p in self.at.split(",") if p.strip()]:
            start, mark, length = part.partition(":")
            try:
                found.append((float(start), float(length)))
            except ValueError as error:
                message = (
                    f"at: {part!r} is no START:DURATION{'' if mark else ' (a colon is missing)'}; write 200:30,430:60"
                )
                raise ValueError(message) from error
        _check_lengths("at", [length for _, length in found])
        if any(not math.isfinite(start) for start, _ in found):
            message = "at: a start is no number"
            raise ValueError(message)
        return tuple(sorted(set(found)))

    def angles(self) -> tuple[float, float, float] | None:
        """Return roll, pitch and heading of the mounting, deg; None: to be estimated."""
        if self.mounting == "auto":
            return None
        return _three("mounting", self.mounting)

    def lever(self) -> tuple[float, float, float]:
        """Return the lever arm, m."""
        found = _three("lever_arm", self.lever_arm)
        if max(map(abs, found)) > LONGEST_ARM:
            message = f"lever_arm is {self.lever_arm} m; no vehicle is longer than {LONGEST_ARM:g} m"
            raise ValueError(message)
        return found

    def delay(self) -> float | None:
        """Return the delay of fixes, s; None: to be estimated."""
        if self.gnss_delay == "auto":
            return None
        (found,) = _numbers("gnss_delay", self.gnss_delay, 1)
        if abs(found) > FARTHEST:
            message = f"gnss_delay is {found:g} s; it must be within {FARTHEST:g} s of 0"
            raise ValueError(message)
        return found

    def degradation(self) -> dict[str, float]:
        """Return noise, jump and every, those that are given."""
        found: dict[str, float] = {}
        for part in [p.strip() for p in self.degrade.split(",") if p.strip()]:
            name, _, text = part.partition("=")
            if name not in ("noise", "jump", "every"):
                message = f"degrade: {part!r}; write noise=M,jump=M,every=S"
                raise ValueError(message)
            (found[name],) = _numbers("degrade", text, 1)
            if found[name] < 0 or (name == "every" and found[name] < 1):
                message = f"degrade: {part!r} cannot be"
                raise ValueError(message)
        return found

    def rate(self) -> float | None:
        """Return the rate of the IMU's clock; None: to be estimated."""
        if self.clock_rate == "auto":
            return None
        (found,) = _numbers("clock_rate", self.clock_rate, 1)
        if not 0.9 < found < 1.1:  # noqa: PLR2004 - a tenth is no clock
            message = f"clock_rate is {found:g}; it must be near 1"
            raise ValueError(message)
        return found

    def scale_factors(self) -> tuple[float, float]:
        """Return sigmas of the scale factors of gyros and accelerometers."""
        gyro, accel = _numbers("scale_factor", self.scale_factor, 2)
        if not 0 <= min(gyro, accel) <= max(gyro, accel) <= 50:  # noqa: PLR2004 - half is no sensor
            message = f"scale_factor is {self.scale_factor!r} %; sigmas are 0 to 50"
            raise ValueError(message)
        return gyro / 100, accel / 100

    def turn_on_sigmas(self) -> tuple[float, float] | None:
        """Return sigmas of turn-on biases, rad/s and m/s²; None: auto."""
        if self.turn_on == "auto":
            return None
        gyro, accel = _numbers("turn_on", self.turn_on, 2)
        if not (0 <= gyro <= 1000 and 0 <= accel <= 100):  # noqa: PLR2004 - more is no sensor
            message = f"turn_on is {self.turn_on!r}; sigmas are 0 to 1000 deg/s and 0 to 100 m/s²"
            raise ValueError(message)
        return math.radians(gyro), accel


def _numbers(name: str, text: str, count: int | None = None) -> tuple[float, ...]:
    try:
        found = tuple(float(part) for part in text.split(",") if part.strip())
    except ValueError as error:
        message = f"{name} is {text!r}; write numbers with commas between"
        raise ValueError(message) from error
    if not found or (count is not None and len(found) != count) or not all(map(math.isfinite, found)):
        message = f"{name} is {text!r}; it must be {count or 'one or more'} finite number{'s' if count != 1 else ''}"
        raise ValueError(message)
    return found


def _three(name: str, text: str) -> tuple[float, float, float]:
    a, b, c = _numbers(name, text, 3)
    return a, b, c


def _check_lengths(name: str, found: tuple[float, ...] | list[float]) -> None:
    wrong = [length for length in found if not SHORTEST <= length <= LONGEST]
    if wrong:
        message = f"{name}: an outage of {wrong[0]:g} s; it must be {SHORTEST:g} to {LONGEST:g} s long"
        raise ValueError(message)
