"""Where the AR processes of 15AR and 27AR come from: the user's static record, the error model, or what follows from it."""

from functools import lru_cache
from pathlib import Path

from imuwb.errors import MissingDataError
from imuwb.log import AXES
from imuwb.navigation import FilterModel
from imuwb.notes import Note
from imuwb.replay import AR_ORDERS, kept, of_static, with_autoregressive
from imuwb.stochastic import Autoregressive, ImuErrorModel, WhiteNoise
from imuwb_plugins.outage.parameters import Parameters


def with_static(model: ImuErrorModel, parameters: Parameters) -> ImuErrorModel:
    """Return an error model whose AR processes are those of the static record of --static; without it, the model itself.

    Raises:
        MissingDataError: the record has no IMU, or an axis allows no AR process.
        UnreadableLogError: the record cannot be read.
    """
    if parameters.static is None:
        return model
    return with_autoregressive(model, _processes(parameters.static, _stamp(parameters.static)))


def _stamp(path: Path) -> tuple[int, int]:
    """Return what changes with the file: the time of its last change, and its size; of a file that is missing, zeros."""
    try:
        state = path.stat()
    except OSError:
        return 0, 0
    return state.st_mtime_ns, state.st_size


@lru_cache(maxsize=1)  # several drives, and the filters that estimate an installation, use the same record
def _processes(path: Path, _stamp: tuple[int, int]) -> dict[str, tuple[Autoregressive, ...]]:
    from imuwb.readers import read  # noqa: PLC0415 - only with --static

    found, why = of_static(read(str(path)).imu())
    for axis in AXES:
        if axis not in found:
            raise MissingDataError(f"--static {path}: {axis} gives no AR process: {why.get(axis, 'it has no samples')}")
    return found


def origin_of(base: FilterModel, names: tuple[str, ...], interval: float, parameters: Parameters) -> str | None:
    """Return where the AR processes of the filters come from; None: no filter has one."""
    orders = [AR_ORDERS[name] for name in names if name in AR_ORDERS]
    if not orders:
        return None
    model = base.error_model
    if parameters.static is not None:
        return f"Burg's method from the static record {parameters.static} after denoising"
    have = [order for order in orders if all(kept(axis, order, interval) is not None for axis in model.axes.values())]
    own = f"the error model {model.name}, which has them"
    follows = (
        f"computed from the processes of the error model {model.name}, in expectation of a long record after denoising"
    )
    if not have:
        others = sorted(
            {len(t.alpha) for a in model.axes.values() for t in a.processes.terms if isinstance(t, Autoregressive)}
        )
        return follows + (f"; its own are of order {', '.join(map(str, others))}" if others else "")
    if len(have) == len(orders):
        return own
    return f"of order {have[0]}: {own}; of the other order: {follows}"


def origin_notes(origin: str | None) -> tuple[Note, ...]:
    """Return a note on where the AR processes come from."""
    if origin is None:
        return ()
    text = f"the AR processes of 15AR and 27AR are from: {origin}. They show what the low-pass of the denoising does, more than the sensor"
    return (Note("autoregressive-origin", text),)


def without_white(models: tuple[FilterModel, ...]) -> tuple[Note, ...]:
    """Return a note on the filters that have an AR process as the only noise of an axis."""
    found: dict[str, list[str]] = {}
    for model in models:
        for axis, own in model.error_model.axes.items():
            terms = own.processes.terms
            alone = any(isinstance(t, Autoregressive) for t in terms) and not any(
                isinstance(t, WhiteNoise) and t.N > 0 for t in terms
            )
            if alone:
                found.setdefault(model.name, []).append(axis)
    return tuple(
        Note(
            "no-white-noise",
            f"{name} has no white noise on {', '.join(axes)}: the error model has an AR process there and no N, so the filter's sigma is too "
            "small; bring both into one model with imuwb model merge NOISE.toml AR.toml --take AR=2",
        )
        for name, axes in found.items()
    )
