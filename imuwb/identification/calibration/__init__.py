"""Calibration: deterministic errors from still positions and from a rate table."""

from imuwb.identification.calibration.axis_calibration import AxisCalibration
from imuwb.identification.calibration.clipping import clipped
from imuwb.identification.calibration.faces import face_name, faces
from imuwb.identification.calibration.magnitude import without_attitudes
from imuwb.identification.calibration.means import Means, means
from imuwb.identification.calibration.motions import Motion
from imuwb.identification.calibration.moved_gyros import MovedGyros, moved_gyros
from imuwb.identification.calibration.positions import (
    PositionCalibration,
    known_attitudes,
    six_position,
)
from imuwb.identification.calibration.printed import PrintedCalibration, as_printed
from imuwb.identification.calibration.rate_table import (
    RateRun,
    RateTableCalibration,
    RunFit,
    TableConditions,
    bends,
    rate_table,
)
from imuwb.identification.calibration.staircase import Staircase, matched, turned_axis
from imuwb.identification.calibration.static_gyros import static_gyros
from imuwb.identification.calibration.steady import shared, steady

__all__ = [
    "AxisCalibration", "Means", "Motion", "MovedGyros", "PositionCalibration", "PrintedCalibration", "RateRun", "RateTableCalibration",
    "RunFit", "Staircase", "TableConditions", "as_printed", "bends", "clipped", "face_name", "faces",
    "known_attitudes", "matched", "means", "moved_gyros", "rate_table", "shared", "six_position", "static_gyros", "steady",
    "turned_axis", "without_attitudes",
]  # fmt: skip
