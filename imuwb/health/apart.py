"""Whether the receivers of a log were recorded at the time of its IMUs."""

from collections.abc import Iterator

from imuwb.health.fault import Fault
from imuwb.log import SECOND, Log
from imuwb.texts import seconds_text

SHARED = 0.5  #: share of the shorter of two records; a receiver that overlaps an IMU by less is worth a warning


def apart(log: Log) -> Iterator[Fault]:
    """Yield receivers whose times do not overlap the IMU's, or only for a small part."""
    spans = [
        (int(t.time[0]), int(t.time[-1]))
        for imu in log.imus
        for t in (imu.angular_rate, imu.specific_force)
        if t is not None and len(t)
    ]
    for gnss in log.gnss if spans else ():
        if not len(gnss):
            continue
        first, last = int(gnss.time[0]), int(gnss.time[-1])
        start, end = max(spans, key=lambda span: min(last, span[1]) - max(first, span[0]))
        common = min(last, end) - max(first, start)
        if common < 0:
            yield Fault(gnss.name, "two clocks", "its times do not overlap the IMU's: two clocks in one file", "fault",
                        consequence="shift one of them before both are used together")  # fmt: skip
        elif common < SHARED * min(last - first, end - start):
            text = f"its times overlap the IMU's for {seconds_text(common / SECOND)} only"
            yield Fault(gnss.name, "little overlap", text, "warning", 1, max(first, start) / SECOND - (log.zero or 0) / SECOND,
                        common / SECOND, "only this part can be used together; is one of the clocks shifted?")  # fmt: skip
