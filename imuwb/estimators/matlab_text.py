"""MATLAB's inertial sensors as lines of one property each: ``gyroparams('NoiseDensity', 1e-4)`` becomes ``gyro.NoiseDensity = 1e-4``.

``gyroparams`` and ``accelparams`` take properties as pairs of a name and a value, as ``Name = value``, or by assignment to the
variable; ``imuSensor`` takes the rate. The generated code of ``imuSensor`` has the bandwidth f where ``NoiseType`` is
single-sided, and f/2 where it is double-sided, which is the default: the noise of a sample is then N √(f/2), and the walk's step
K/√(f/2). So a double-sided N is √2 times, and K 1/√2 times, the value that single-sided noise has.
"""

import math
import re

_MAKERS = {"gyroparams": "gyro", "accelparams": "accel"}
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_VALUE = r"\[[^\]]*+\]|[^,;()\[\]]++(?:\([^()]*+\))?[^,;()\[\]]*+"
_CALL = re.compile(rf"(?:\b(\w++)\s*+=\s*+)?\b({'|'.join(_MAKERS)})\s*+(?:\(((?:[^()]|\([^()]*+\))*+)\))?")
_PAIR = re.compile(rf"[\"'](\w+)[\"']\s*,\s*({_VALUE})|\b(\w++)\s*+=\s*+({_VALUE})")
_RATE = re.compile(rf"[\"']?SampleRate[\"']?\s*[,=]\s*({_NUMBER})\s*[,);]")
#: property -> how many times a double-sided value is that of single-sided noise
_DOUBLE = {"NoiseDensity": math.sqrt(2), "RandomWalk": 1 / math.sqrt(2)}
_DIGITS = 17


def is_matlab(text: str) -> bool:
    """Return whether a text makes the parameters of one of MATLAB's inertial sensors."""
    return any(re.search(rf"\b{maker}\b", text) for maker in _MAKERS)


def matlab_lines(text: str) -> tuple[str, tuple[str, ...]]:
    """Return a script as lines of one property each, single-sided, and what was converted or has no place in a model."""
    plain = re.sub(r"\.\.\.[^\n]*\n", " ", re.sub(r"(?m)%.*$", "", text))
    lines = [f"sampleRate = {found[1]};" for found in [_RATE.search(plain)] if found]
    notes: list[str] = []
    for sensor in _MAKERS.values():
        stated = _stated(plain, sensor)
        double = "single" not in stated.pop("NoiseType", "double-sided")
        for name, value in stated.items():
            factor = _DOUBLE.get(name, 1.0) if double else 1.0
            lines.append(f"{sensor}.{name} = {_scaled(value, factor)};")
        if double and _DOUBLE.keys() & stated.keys():
            notes.append(
                f"{sensor}: NoiseType is double-sided, MATLAB's default: N is its NoiseDensity over √2, K its RandomWalk times √2"
            )
        if "BiasInstability" in stated and "BiasInstabilityCoefficients" not in stated:
            notes.append(
                f"{sensor}: MATLAB's default coefficients make its BiasInstability nearly white; here it is B of flicker noise"
            )
    lines += re.findall(r"(?m)^\s*(?:sampleRate|horizon)\s*=[^;\n]+;", plain)
    return "\n".join(lines), tuple(notes)


def _stated(text: str, sensor: str) -> dict[str, str]:
    """Return the properties of a sensor, as text."""
    found: dict[str, str] = {}
    for call in _CALL.finditer(text):
        if _MAKERS[call[2]] != sensor:
            continue
        for pair in _PAIR.finditer(call[3] or ""):
            found[pair[1] or pair[3]] = (pair[2] or pair[4]).strip()
        if call[1]:
            for line in re.finditer(rf"(?m)^\s*(?:\w+\.)?{call[1]}\.(\w+)\s*=\s*([^;\n]+)", text):
                found[line[1]] = line[2].strip()
    return found


def _scaled(value: str, factor: float) -> str:
    """Return plain numbers divided by a factor; other text as it is, which a reader then refuses."""
    if factor == 1.0 or re.search(r"[*/^a-df-zA-DF-Z]", value):
        return value
    return re.sub(_NUMBER, lambda number: f"{float(number[0]) / factor:.{_DIGITS}g}", value)
