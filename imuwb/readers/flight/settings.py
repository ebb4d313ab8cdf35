"""The parameters by which an autopilot corrects inertial samples before it logs them."""

import math
import re
from collections.abc import Iterable

from imuwb.readers.batch import Remark

#: ArduPilot: libraries/AP_InertialSensor; PX4: src/modules/sensors and src/lib/sensor_calibration
RELEVANT = re.compile(
    r"INS_TCAL\d_(ENABLE|TMIN|TMAX|(ACC|GYR)[123]_[XYZ])|INS_(ACC|GYR)\d?(OFFS|SCAL)_[XYZ]|INS_(ACC|GYR)\d_CALTEMP|AHRS_ORIENTATION"
    r"|CAL_(ACC|GYRO)\d_([XYZ](OFF|SCALE)|ID|ROT)|TC_[AG](_ENABLE|\d_(ID|TREF|TMIN|TMAX|X[0-3]_[012]))|SENS_BOARD_(ROT|[XYZ]_OFF)"
)


def settings_of(stated: Iterable[tuple[str, float]]) -> Remark:
    """Return the parameters that bear on inertial samples, of all that a log states; one that changes in the log is nan.

    The remark has no text.
    """
    settings: dict[str, float] = {}
    for name, value in stated:
        if RELEVANT.fullmatch(name):
            settings[name] = value if settings.get(name, value) == value else math.nan
    return Remark("", settings=settings)
