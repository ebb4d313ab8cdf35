"""What a user can do next with a log or an error model, by the analyses that are installed."""

from collections.abc import Collection, Iterator

from imuwb import registry
from imuwb.analysis import Step

EXPORT = Step("imuwb model export {log} --to kalibr", "the numbers for an estimator")


def analysis_steps(kinds: Collection[str]) -> Iterator[Step]:
    """Yield the analysis that suits a log with such kinds of streams: of a drive, or of a still sensor."""
    drives = {"imu", "gnss"} <= set(kinds)
    fits = registry.marked(registry.ANALYSES, "DEMO", value="drive" if drives else "still")
    if fits and "imu" in kinds:
        model = " --error-model MODEL.toml" if drives else ""
        yield Step(f"imuwb {fits[0]} {{log}}{model}", registry.summary_of(fits[1]).partition(":")[0])


def model_steps() -> Iterator[Step]:
    """Yield what an error model is good for: a replay of a drive, and the file of an estimator."""
    if replay := registry.marked(registry.ANALYSES, "DEMO", value="drive"):
        yield Step(f"imuwb {replay[0]} DRIVE --error-model {{log}}", registry.summary_of(replay[1]).partition(":")[0])
    yield EXPORT
