"""Tabs of the noise analysis."""

from imuwb.analysis import Review
from imuwb.noise_results import autoregressive_table
from imuwb_plugins.allan import imus as allan_imus
from imuwb_plugins.noise import show_denoising, show_repeatability, summary
from imuwb_plugins.noise.compute import ANALYSES
from imuwb_plugins.noise.result import TITLES, Result

AUTOREGRESSIVE = (
    "x(n) = -sum alpha_k x(n-k) + beta0 w(n), by Burg's method from samples without any detail of 7 levels (accelerometers y and z: 6). The "
    "error model keeps them beside its sum, for the filters 15AR and 27AR of imuwb outage. They show the low-pass of the denoising at this "
    "rate, and the size of the noise that passes it; how the sensor's bias decays they do not show."
)


def draw(result: Result, review: Review) -> None:
    """Show all estimates side by side, then each analysis on its own tab."""
    review.tab("Estimates")
    for note in result.notes:
        review.note(note)
    if result.repeatability is not None:
        show_repeatability.draw(result.repeatability, review)
    else:
        summary.draw(result.axes, review)
    for i, part in enumerate(result.parts):
        for name, content in part.items():
            log = result.repeatability.names[i] if result.repeatability is not None else ""
            review.tab(f"{TITLES[name]} {log}".strip())
            ANALYSES[name].draw(content, review)
    if result.denoising is not None or result.autoregressive:
        review.tab("Denoising")
    if result.denoising is not None:
        show_denoising.draw(result.denoising, review)
    if result.autoregressive:
        review.table(autoregressive_table(result.autoregressive, AUTOREGRESSIVE))


def draw_imus(result: allan_imus.ImuComparison, review: Review) -> None:
    """Show the noise of all IMUs in one table."""
    allan_imus.draw_imus(result, review)
