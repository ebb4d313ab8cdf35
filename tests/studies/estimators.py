"""Files of estimators in their consumers: which load them, and how their noise grows there, over that of the model.

    python tests/studies/estimators.py [--pyins FOLDER] [--sdformat FOLDER] > tests/studies/estimators.md

Each tool's own step, written from its source in ``tests/estimators/test_consumers.py``, is propagated for 60 s with the values of
the exported file. Consumers that are installed load the file too: gtsam runs it and integrates, pymavlink and a YAML reader
parse it, pyins (a checkout) builds its estimation models from it, and SDFormat's description of
``noise`` knows its elements (``noise.sdf``). Install with
``pip install gtsam pymavlink pyyaml``; gtsam has wheels for numpy 2 from 4.3 on.
"""

import argparse
import contextlib
import importlib.util
import math
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np

from imuwb.estimators import Options, export, tools
from imuwb.estimators.growth import walk_variance, white_variance
from imuwb.stochastic import AxisModel, Constant, ImuErrorModel, RandomWalk, Sum, WhiteNoise

ROOT = Path(__file__).parents[1]
RATE, HORIZON = 200.0, 60.0
GYRO, ACCEL = (1.6e-4, 1.2e-6), (2.1e-3, 3e-4)


def sensor() -> ImuErrorModel:
    """Return the sensor whose files are made."""
    axes = {
        f"{name}_{axis}": AxisModel(Sum((WhiteNoise(n), RandomWalk(k), Constant(1e-3))))
        for name, (n, k) in (("gyro", GYRO), ("accel", ACCEL))
        for axis in "xyz"
    }
    return ImuErrorModel("study", axes, {"rate": f"{RATE:g} Hz"})


def true(n: float, k: float) -> np.ndarray:
    """Return the sd of one, two and three integrals after the horizon."""
    return np.sqrt([white_variance(n, HORIZON, times) + walk_variance(k, HORIZON, times) for times in (1, 2, 3)])


def consumers() -> dict:
    """Return the consumers' steps of the tests."""
    spec = importlib.util.spec_from_file_location("consumers", ROOT / "estimators" / "test_consumers.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return {name: (step, module.grown) for name, step in module.CONSUMERS.items()}


def gtsam_ratios(text: str) -> str:
    """Run the exported file, integrate for the horizon, and return sd of attitude, velocity and position over the true one."""
    import gtsam

    scope: dict = {}
    exec(compile(text, "gtsam.py", "exec"), scope)  # noqa: S102 - a file of ours
    still = gtsam.PreintegratedCombinedMeasurements(scope["params"], gtsam.imuBias.ConstantBias())
    for _ in range(round(HORIZON * RATE)):
        still.integrateMeasurement(np.zeros(3), np.zeros(3), 1 / RATE)
    sd = np.sqrt(np.diag(still.preintMeasCov()))
    gyro, accel = true(*GYRO), true(*ACCEL)
    found = (sd[0] / gyro[0], sd[6] / accel[0], sd[3] / accel[1])
    return f"run by gtsam {version('gtsam')}: attitude {found[0]:.4f}, velocity {found[1]:.4f}, position {found[2]:.4f}"


def pyins_ratios(text: str, folder: Path) -> str:
    """Build the estimation models, and return sd of attitude and velocity over the true one, from their own matrices."""
    sys.path.insert(0, str(folder))
    scope: dict = {}
    exec(compile(text, "pyins.py", "exec"), scope)  # noqa: S102 - a file of ours
    ratios = []
    for name, size in (("gyro_model", GYRO), ("accel_model", ACCEL)):
        model = scope[name]
        drive = np.asarray(model.G[0] * model.q)
        k = float(np.sqrt(np.sum(drive**2)))
        n = float(model.v[0])
        ratios.append(math.sqrt(white_variance(n, HORIZON, 1) + walk_variance(k, HORIZON, 1)) / true(*size)[0])
    return f"built by pyins: attitude {ratios[0]:.4f}, velocity {ratios[1]:.4f}"


def parameters(path: Path, values: dict) -> str:
    """Load a file of parameters by pymavlink."""
    from pymavlink.mavparm import MAVParmDict

    loaded = MAVParmDict()
    with contextlib.redirect_stdout(None):
        loaded.load(str(path))
    worst = max(abs(loaded[key] / value[0] - 1) for key, value in values.items())
    return f"loaded by pymavlink: {len(values)} values, largest difference {worst:.1e}"


def yaml_values(text: str, values: dict) -> str:
    """Load a YAML file."""
    import yaml

    document = yaml.safe_load(text.removeprefix("%YAML:1.0\n"))
    flat: dict = {}

    def walk(node: dict) -> None:
        for key, value in node.items():
            walk(value) if isinstance(value, dict) else flat.__setitem__(key, value)

    walk(document)
    same = all(
        np.allclose(flat[key], value if len(value) > 1 or isinstance(flat[key], list) else value[0], rtol=1e-8)
        for key, value in values.items()
    )
    return f"loaded by PyYAML: {len(values)} values, {'equal' if same else 'NOT EQUAL'}"


def described(text: str, folder: Path) -> str:
    """Check each element of noise against SDFormat's own description, noise.sdf: its name, and that its value has its type."""
    from xml.etree import ElementTree as ET

    known = {e.get("name"): e.get("type") for e in ET.parse(folder / "noise.sdf").getroot().iter("element")}  # noqa: S314 - a file of SDFormat
    elements = [e for noise in ET.fromstring(text).iter("noise") for e in noise]  # noqa: S314 - a file of ours
    unknown = sorted({e.tag for e in elements} - set(known))
    numbers = [float(e.text) for e in elements if known.get(e.tag) in ("double", "float")]
    return f"{len(numbers)} numbers as SDFormat {folder.name} describes them, unknown elements: {', '.join(unknown) or 'none'}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pyins", type=Path)
    parser.add_argument("--sdformat", type=Path)
    given = parser.parse_args()
    steps = consumers()
    print(
        "# Exported files in their consumers\n\nMade by `python tests/studies/estimators.py`. Sensor: N 1.6e-4 rad/s/√Hz and 2.1e-3 m/s²/√Hz, K 1.2e-6 rad/s²/√Hz and 3e-4 m/s³/√Hz, 200 Hz."
    )
    print("Ratio: sd of attitude, velocity and position after 60 s in the tool's own step, over that of the model.\n")
    print(
        "| tool | gyro: attitude, ×2, ×3 | accelerometer: velocity, position, ×3 | loaded by the consumer |\n|---|---|---|---|"
    )
    for name, tool in tools().items():
        made = export(sensor(), name, Options(horizon=HORIZON, scale_factor=1e-4))
        ratios = ["-", "-"]
        if name in steps:
            step, grown = steps[name]
            values = {key: value[0] for key, value in made.values.items()}
            ratios = [
                ", ".join(f"{r:.4f}" for r in grown(*one) / true(*size))
                for one, size in zip(step(values), (GYRO, ACCEL), strict=True)
            ]
        print(f"| {name} | {ratios[0]} | {ratios[1]} | {loaded(name, tool, made, given)} |")


def loaded(name: str, tool, made, given) -> str:
    """Return what the consumer says of the file."""
    said = "its step only"
    try:
        if name == "gtsam":
            said = gtsam_ratios(made.text)
        elif name == "pyins" and given.pyins:
            said = pyins_ratios(made.text, given.pyins)
        elif tool.suffix in (".params", ".parm"):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / f"file{tool.suffix}"
                path.write_text(made.text, "utf-8")
                said = parameters(path, made.values)
        elif tool.suffix == ".yaml":
            said = yaml_values(made.text, made.values)
        elif name == "gazebo" and given.sdformat:
            said = described(made.text, given.sdformat)
    except ImportError as error:
        said = f"not loaded: {error}"
    return said


if __name__ == "__main__":
    main()
