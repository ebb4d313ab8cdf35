"""The errors of each filter in each outage, in terms that several analyses share."""

from imuwb.analysis import Drift
from imuwb_plugins.outage.drives import Drives
from imuwb_plugins.outage.result import Result


def drifts(result: Result | Drives) -> tuple[Drift, ...]:
    """Return the errors of each filter in each outage, of all drives."""
    results = result.drives.values() if isinstance(result, Drives) else (result,)
    return tuple(
        Drift(
            filter=name, outage_start=outage.start, outage_duration=outage.duration, end=own.end, mean=own.mean, max=own.max,
            vertical=own.vertical, velocity=own.velocity, heading=own.heading,
            share=None if own.percent is None else own.percent / 100, sigma=own.sigma, nees=own.nees, motion=outage.motion,
            mean_speed=outage.mean_speed, name=outage.name,
        )
        for one in results
        for outage in one.outages
        for name, own in outage.models.items()
    )  # fmt: skip
