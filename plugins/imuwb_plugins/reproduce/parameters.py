"""Options of a paper's reproduction."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from imuwb.options import NOT_NEGATIVE, Between, Options


@dataclass(frozen=True)
class Repeated(Options):
    """The seeds."""

    seed: Annotated[int, "Seed of the random numbers; the first of several.", NOT_NEGATIVE] = 0
    seeds: Annotated[
        int, "Number of simulations: our values are their means, and the intervals those in which one more simulation would lie.",
        Between(1, 1000),
    ] = 1  # fmt: skip


@dataclass(frozen=True)
class Quinchia(Repeated):
    """Quinchia and others (2013): noise of a MEMS IMU, and filters with five error models in GNSS outages.

    Simulates the paper's sensor and drives, runs the analyses, and sets every table and figure of the paper beside ours.

    Example: imuwb reproduce quinchia -o quinchia.rrd --html quinchia.html
    """

    static: Annotated[Path | None, "A still record of your own, in place of the simulated one."] = None
    drive: Annotated[tuple[Path, ...], "Drives of your own, one or two, in place of the simulated ones."] = ()
    hours: Annotated[float, "Length of the simulated still record (h); the paper's is 7.", Between(0.1, 100.0)] = 7.0

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        if len(self.drive) > 2:  # noqa: PLR2004 - the paper has two
            raise ValueError(f"drive has {len(self.drive)} logs; it must have one or two")
        if self.drive and self.static is None:
            raise ValueError(
                "drive is given without static; it must be used with --static LOG: the filters take their noise from a still record of the same sensor"
            )
        if self.seeds > 1 and (self.static is not None or self.drive):
            raise ValueError("seeds needs simulated logs; leave static and drive out, or give one seed")


@dataclass(frozen=True)
class ElDiasty(Repeated):
    """El-Diasty and others: noise of two MEMS IMUs at chamber temperatures, before and after a Kaiser low-pass.

    Simulates the y axes of the paper's sensors, runs the analyses, and sets every table and figure of the paper beside ours.

    Example: imuwb reproduce el-diasty -o el-diasty.rrd --html el-diasty.html
    """

    chamber: Annotated[
        tuple[Path, ...], "Four still logs of your own, at -30, 0, 30 and 60 °C in this order, in place of the simulated ones."
    ] = ()  # fmt: skip
    hours: Annotated[float, "Length of each simulated record (h); the paper's is 3.", Between(0.05, 100.0)] = 3.0

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        if len(self.chamber) not in (0, 4):
            raise ValueError(
                f"chamber names {len(self.chamber)} of the four logs that it must have, at -30, 0, 30 and 60 °C"
            )
        if self.seeds > 1 and self.chamber:
            raise ValueError("seeds needs simulated logs; leave chamber out, or give one seed")


@dataclass(frozen=True)
class Hassaballa(Repeated):
    """Hassaballa and others: Allan variance of an MPU-6050 at several rates and bandwidths, and its calibration.

    Simulates the paper's sensor, runs the analyses, and sets every table and figure of the paper beside ours.

    Example: imuwb reproduce hassaballa -o hassaballa.rrd --html hassaballa.html
    """

    static: Annotated[
        Path | None, "A still record of your own, of 200 Hz or a multiple, without a narrow low-pass, in place of the simulated one."
    ] = None  # fmt: skip
    hours: Annotated[float, "Length of the simulated record (h); the paper's is 2.", Between(0.05, 20.0)] = 2.0

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        if self.seeds > 1 and self.static is not None:
            raise ValueError("seeds needs simulated logs; leave static out, or give one seed")
