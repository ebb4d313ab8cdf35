"""Calibration files of Kalibr, OpenVINS, imu_tk, imu_calib, PX4 and ArduPilot."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import MissingDataError, UsageError
from imuwb.estimators.calibration.matrices import Matrices, lower_and_turn
from imuwb.estimators.calibration.thermal import device_row, instance_of
from imuwb.estimators.temperature import constant
from imuwb.stochastic import ImuErrorModel, is_ideal
from imuwb.texts import printable

INSTANCES = {"px4-cal": 3, "ardupilot-ins": 2}  #: form -> largest number of an IMU
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

_TRIAD = 21  #: numbers of imu_tk for one triad: 9 + 9 + 3


@dataclass(frozen=True, slots=True)
class CalibrationFile:
    """One form of calibration file."""

    title: str
    source: str
    write: Callable[[Matrices], tuple[list[str], list[str]]]  #: returns lines and notes
    read: Callable[[str], Matrices | None]  #: returns None where the text is of another form
    suffix: str


def calibration_text(
    model: ImuErrorModel, name: str, instance: int | None = None, celsius: float | None = None
) -> tuple[str, tuple[str, ...]]:
    """Return the calibration of a model in a form, and what has no place there.

    Args:
        model: with deterministic terms.
        name: one of ``FILES``.
        instance: number of the autopilot's IMU, from 0, for its parameters; by default that of the model's log, else 0.
        celsius: °C at which terms that depend on temperature are taken; by default the model's constant terms.

    Raises:
        UsageError: no such form or instance, or a temperature outside of the model's.
        MissingDataError: the model has no deterministic term.
    """
    if name not in FILES:
        raise UsageError(f"--to {name}: there is no such calibration; it must be one of {', '.join(FILES)}")
    if is_ideal(model):
        raise MissingDataError(
            f"model {model.name} has no bias, scale factor or cross-coupling; a calibration gives such a model"
        )
    form = FILES[name]
    model, by_temperature = constant(model, celsius)
    try:
        lines, notes = form.write(Matrices.of(model))
    except ValueError as error:
        raise UsageError(f"model {model.name}: {error}") from error
    if name in INSTANCES:
        lines = _of_instance(lines, model, name, instance_of(model, instance, INSTANCES[name]))
    notes += by_temperature
    source = "; ".join(f"{key}: {text}" for key, text in model.provenance.items())
    head = [form.title, f"facts from {form.source}", f"model {model.name}" + (f", {source}" if source else ""), *notes]
    comments = [f"# {printable(' '.join(text.split()))}" for text in head]
    first = 1 if lines[0].startswith("%YAML") else 0
    if name == "imu-tk":  # its reader takes numbers only
        return "\n".join(lines) + "\n", tuple(notes)
    return "\n".join([*lines[:first], *comments, *lines[first:]]) + "\n", tuple(notes)


def _of_instance(lines: list[str], model: ImuErrorModel, name: str, place: int) -> list[str]:
    """Return the parameters of an autopilot's first IMU as those of another, with the numbers of the devices where PX4 has them."""
    if name == "ardupilot-ins":
        number = "" if place == 0 else str(place + 1)
        return [re.sub(r"^INS_(ACC|GYR)", rf"INS_\g<1>{number}", line) for line in lines]
    lines = [re.sub(r"^CAL_(ACC|GYRO)0", rf"CAL_\g<1>{place}", line) for line in lines]
    devices = [(sensor, f"CAL_{short}{place}_ID") for sensor, short in (("accel", "ACC"), ("gyro", "GYRO"))]
    return [*lines, *(device_row(model, sensor, parameter) for sensor, parameter in devices)]


def calibration_lines(model: ImuErrorModel, name: str) -> tuple[list[str], list[str]]:
    """Return the lines that a form has under ``imu0:``, and notes; those of a perfect sensor where the model has no term.

    Raises:
        UsageError: a calibration that mirrors the axes.
    """
    try:
        lines, notes = FILES[name].write(Matrices.of(model))
    except ValueError as error:
        raise UsageError(f"model {model.name}: {error}") from error
    return lines[lines.index("imu0:") + 1 :], [] if is_ideal(model) else notes


def read_calibration_text(text: str, where: str) -> tuple[str, ImuErrorModel] | None:
    """Return form and error model of a calibration file; None where the text is of no known form.

    Raises:
        UsageError: a matrix that cannot be inverted.
    """
    plain = re.sub(r"(?m)(?:^|(?<=\s))#.*$", "", text)
    for name, form in FILES.items():
        try:
            found = form.read(plain)
            if found is not None:
                found.check()
        except (ValueError, np.linalg.LinAlgError) as error:
            raise UsageError(f"{where}: read as {name}: {error}") from error
        if found is not None:
            model = found.model(name, f"{where}, read as {name}")
            return name, _one_triad(model, where) if name == "imu-tk" and len(plain.split()) == _TRIAD else model
    return None


def _one_triad(model: ImuErrorModel, where: str) -> ImuErrorModel:
    """Return a model that was read as one of accelerometers alone; as one of gyros, where the file's name says so."""
    gyro = "gyr" in re.split(r"[\\/]", where)[-1].lower()
    name = "gyro" if gyro else "accel"
    axes = {f"{name}_{letter}": model.axes[f"accel_{letter}"] for letter in "xyz"}
    doubt = f"one triad, taken as that of the {'gyros' if gyro else 'accelerometers'} by the name of the file"
    return replace(model, axes=axes, doubts=(*model.doubts, doubt))


def _rows(matrix: Floats) -> list[str]:
    return [f"- [{', '.join(f'{v:.12g}' for v in row)}]" for row in matrix]


def _lost(what: str, size: float, unit: str) -> list[str]:
    return [f"{what} have no place here and are left out: up to {size:.3g} {unit}"] if size > 0 else []


def _off_diagonal(matrix: Floats) -> float:
    return float(np.abs(matrix - np.diag(np.diag(matrix))).max())


def _turned(matrices: Matrices) -> tuple[Floats, Floats, Floats, Floats, list[str]]:
    """Return M_a, M_g, C_gyro_i and A in the frame that makes M_a lower triangular (Kalibr's IMU frame), and a note on it."""
    accel, turn = lower_and_turn(matrices.accel)
    gyro, gyro_turn = lower_and_turn(matrices.gyro)
    angle = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    notes = [
        f"the IMU frame here is that of the accelerometers' x axis and x-y plane: turned by {1e3 * angle:.3g} mrad from that of the model"
    ]
    biases = max(float(np.abs(matrices.gyro_bias).max()), float(np.abs(matrices.accel_bias).max()))
    notes += ["biases have no place here; the estimator finds them"] if biases > 0 else []
    return accel, gyro, gyro_turn @ turn.T, matrices.leak @ turn.T, notes


def _kalibr(matrices: Matrices) -> tuple[list[str], list[str]]:
    accel, gyro, between, leak, notes = _turned(matrices)
    lines = [
        "imu0:",
        "  model: scale-misalignment",
        "  accelerometers:",
        "    M:",
        *(f"    {row}" for row in _rows(accel)),
        "  gyroscopes:",
    ]
    for key, matrix in (("A", leak), ("C_gyro_i", between), ("M", gyro)):
        lines += [f"    {key}:", *(f"    {row}" for row in _rows(matrix))]
    return lines, notes


def _read_kalibr(text: str) -> Matrices | None:
    accel, gyro = (  # with the lines below that are further in
        re.search(rf"(?m)^([ \t]*){name}:[^\n]*\n((?:\1[ \t]+[^\n]*\n?|\s*\n)*)", text)
        for name in ("accelerometers", "gyroscopes")
    )
    if accel is None or gyro is None:
        return None
    m_a, m_g, between, leak = (
        _matrix(accel[2], "M"),
        _matrix(gyro[2], "M"),
        _matrix(gyro[2], "C_gyro_i"),
        _matrix(gyro[2], "A"),
    )
    if m_a is None or m_g is None:
        return None
    between = np.eye(3) if between is None else between
    return Matrices(m_g @ between, np.zeros(3), np.zeros((3, 3)) if leak is None else leak, m_a, np.zeros(3))


def _openvins(matrices: Matrices) -> tuple[list[str], list[str]]:
    accel, gyro, between, leak, notes = _turned(matrices)
    lines = ["%YAML:1.0", "imu0:", '  model: "kalibr"']
    parts = (("Tw", gyro), ("R_IMUtoGYRO", between), ("Ta", accel), ("R_IMUtoACC", np.eye(3)), ("Tg", leak))
    for key, matrix in parts:
        lines += [f"  {key}:", *(f"    {row}" for row in _rows(matrix))]
    return lines, notes


def _read_openvins(text: str) -> Matrices | None:
    tw, ta, tg = (_matrix(text, key) for key in ("Tw", "Ta", "Tg"))
    if tw is None or ta is None:
        return None
    gyro, accel = (_matrix(text, key) for key in ("R_IMUtoGYRO", "R_IMUtoACC"))
    m_g = tw @ (np.eye(3) if gyro is None else gyro)
    m_a = ta @ (np.eye(3) if accel is None else accel)
    return Matrices(m_g, np.zeros(3), np.zeros((3, 3)) if tg is None else tg, m_a, np.zeros(3))


def _imu_tk(matrices: Matrices) -> tuple[list[str], list[str]]:
    """Return the accelerometers' misalignment, scale and bias, then those of the gyros, a blank line after each block."""
    lines: list[str] = []
    for gain, bias in ((matrices.accel, matrices.accel_bias), (matrices.gyro, matrices.gyro_bias)):
        undo = np.linalg.inv(gain)
        scale = np.diag(np.diag(undo))
        for block in (undo @ np.linalg.inv(scale), scale, bias[:, None]):
            lines += [" ".join(f"{v:.12g}" for v in row) for row in block]
            lines.append("")
    notes = _lost("the gyros' sensitivities to acceleration", float(np.abs(matrices.leak).max()), "rad/s per m/s²")
    return lines[:-1], notes


def _read_imu_tk(text: str) -> Matrices | None:
    """Return the matrices of both triads, one after the other; those of one triad alone are of the accelerometers."""
    words = text.split()
    if len(words) not in (_TRIAD, 2 * _TRIAD) or not all(re.fullmatch(_NUMBER, word) for word in words):
        return None
    numbers = np.array([float(word) for word in words]).reshape(-1, _TRIAD)
    found = [(_inverse(row[:9].reshape(3, 3) @ row[9:18].reshape(3, 3)), row[18:]) for row in numbers]
    (accel, accel_bias), (gyro, gyro_bias) = [*found, (np.eye(3), np.zeros(3))][:2]
    return Matrices(gyro, gyro_bias, np.zeros((3, 3)), accel, accel_bias)


def imu_tk_files(text: str) -> dict[str, str]:
    """Return the two files that imu_tk loads, one for each triad, by the word that stands in their names."""
    lines = text.splitlines()
    half = (len(lines) + 1) // 2  # a blank line between them
    return {"acc": "\n".join(lines[:half]).rstrip() + "\n", "gyro": "\n".join(lines[half:]) + "\n"}


def _imu_calib(matrices: Matrices) -> tuple[list[str], list[str]]:
    undo = np.linalg.inv(matrices.accel)
    values = (("SM", undo.ravel()), ("bias", undo @ matrices.accel_bias))
    notes = ["the gyros have no place here: imu_calib takes their bias at each start"]
    return [f"{key}: [{', '.join(f'{v:.12g}' for v in value)}]" for key, value in values], notes


def _read_imu_calib(text: str) -> Matrices | None:
    found = {key: _list(text, key) for key in ("SM", "bias")}
    scale, bias = found["SM"], found["bias"]
    if scale is None or bias is None or len(scale) != 9 or len(bias) != 3:  # noqa: PLR2004 - a matrix and a vector
        return None
    accel = _inverse(scale.reshape(3, 3))
    return Matrices(np.eye(3), np.zeros(3), np.zeros((3, 3)), accel, accel @ bias)


def _parameters(matrices: Matrices, names: Callable[[str, str], str], form: str) -> tuple[list[str], list[str]]:
    gains = np.diag(matrices.accel)
    rows: list[tuple[str, float]] = []
    for i, axis in enumerate("XYZ"):
        rows += [(names("accel offset", axis), float(matrices.accel_bias[i])), (names("accel scale", axis), float(1 / gains[i])),
                 (names("gyro offset", axis), float(matrices.gyro_bias[i]))]  # fmt: skip
    notes = _lost("cross-couplings of the accelerometers", 1e3 * _off_diagonal(matrices.accel), "mrad")
    notes += _lost(
        "scale factors and cross-couplings of the gyros",
        1e3 * float(np.abs(matrices.gyro - np.eye(3)).max()),
        "parts in 1000",
    )
    notes += _lost("the gyros' sensitivities to acceleration", float(np.abs(matrices.leak).max()), "rad/s per m/s²")
    notes.append("axes are those of the model; the autopilot applies these values before its board rotation")
    return [form.format(name, f"{value:.9g}") for name, value in rows], notes


def _px4_name(what: str, axis: str) -> str:
    return {"accel offset": "CAL_ACC0_{}OFF", "accel scale": "CAL_ACC0_{}SCALE", "gyro offset": "CAL_GYRO0_{}OFF"}[
        what
    ].format(axis)


def _ardupilot_name(what: str, axis: str) -> str:
    return {"accel offset": "INS_ACCOFFS_{}", "accel scale": "INS_ACCSCAL_{}", "gyro offset": "INS_GYROFFS_{}"}[
        what
    ].format(axis)


def _read_parameters(names: Callable[[str, str], str]) -> Callable[[str], Matrices | None]:
    def read(text: str) -> Matrices | None:
        def triple(what: str, otherwise: float) -> Floats:
            values = [_list(text, names(what, axis)) for axis in "XYZ"]
            return np.array([otherwise if value is None else float(value[0]) for value in values], dtype=np.float64)

        if not re.search(rf"(?<!\w){names('accel offset', 'X')}(?!\w)", text):
            return None
        gains = np.diag(1.0 / triple("accel scale", 1.0))
        return Matrices(np.eye(3), triple("gyro offset", 0.0), np.zeros((3, 3)), gains, triple("accel offset", 0.0))

    return read


def _inverse(matrix: Floats) -> Floats:
    """Return the inverse of a matrix."""
    return np.linalg.inv(matrix).astype(np.float64)


def _matrix(text: str, key: str) -> Floats | None:
    """Return the 3 × 3 matrix after a key of YAML, in rows with or without dashes and brackets; None where no list is there.

    Raises:
        ValueError: a list of another size.
    """
    found = re.search(rf"(?<!\w){key}:((?:[\s\[\],]|-\s|{_NUMBER}(?![\d.eE]))*)", text)
    if found is None or not re.match(r"\s*(?:-\s|\[)", found[1]):
        return None
    numbers = re.findall(_NUMBER, re.sub(r"-\s+", " ", found[1]))
    if len(numbers) != 9:  # noqa: PLR2004 - 3 × 3
        raise ValueError(f"{key} has {len(numbers)} numbers; it must have three rows of three")
    return np.array([float(n) for n in numbers]).reshape(3, 3)


def _list(text: str, key: str) -> Floats | None:
    found = re.search(rf"(?<!\w){key}\s*[:=,\s]\s*\[?((?:{_NUMBER}[,\s]*)+)", text)
    return None if found is None else np.array([float(n) for n in re.findall(_NUMBER, found[1])])


FILES: Mapping[str, CalibrationFile] = {
    "kalibr-imu": CalibrationFile(
        "Kalibr, scale-misalignment model: measured = M C_gyro_i ω + A a + b, and M a + b",
        "ethz-asl/kalibr: kalibr_imu_camera_calibration/IccSensors.py (IccScaledMisalignedImu)", _kalibr, _read_kalibr, ".yaml",
    ),
    "openvins-imu": CalibrationFile(
        "OpenVINS, IMU intrinsics: measured = Tw R ω + Tg a + b, and Ta R a + b",
        "rpng/open_vins: ov_msckf/src/sim/Simulator.cpp, VioManagerOptions.h (Tg is A C_gyro_i of Kalibr, equal where C_gyro_i is a unit matrix)",
        _openvins, _read_openvins, ".yaml",
    ),
    "imu-tk": CalibrationFile(
        "imu_tk: misalignment, scale and bias of the accelerometers, then of the gyros; true = T K (raw - b)",
        "Kyle-ak/imu_tk: include/imu_tk/calibration.h", _imu_tk, _read_imu_tk, ".calib",
    ),
    "imu-calib": CalibrationFile(
        "imu_calib for ROS: accelerometers only; true = SM raw - bias",
        "dpkoch/imu_calib: src/accel_calib.cpp", _imu_calib, _read_imu_calib, ".yaml",
    ),
    "px4-cal": CalibrationFile(
        "PX4 calibration parameters: true = (raw - OFF) SCALE",
        "PX4/PX4-Autopilot: src/lib/sensor_calibration/Accelerometer.hpp, Gyroscope.hpp",
        lambda m: _parameters(m, _px4_name, "{}\t{}"), _read_parameters(_px4_name), ".params",
    ),
    "ardupilot-ins": CalibrationFile(
        "ArduPilot calibration parameters: true = (raw - OFFS) SCAL",
        "ArduPilot/ardupilot: libraries/AP_InertialSensor/AP_InertialSensor_Backend.cpp",
        lambda m: _parameters(m, _ardupilot_name, "{} {}"), _read_parameters(_ardupilot_name), ".parm",
    ),
}  # fmt: skip
