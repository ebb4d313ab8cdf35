"""What is done to samples before they are analysed or navigated with: arrays in, arrays out.

Names are imported when they are first used: denoising need not wait for the filters' libraries.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from imuwb.conditioning.kaiser import KaiserFilter, design_kaiser, filtered
    from imuwb.conditioning.lowpass import Lowpass, design_lowpass
    from imuwb.conditioning.streams import Change, condition_streams
    from imuwb.conditioning.wavelet import Denoised, band_limit, denoise, denoise_causally, level_of_band, measured_band

__all__ = [
    "Change",
    "Denoised",
    "KaiserFilter",
    "Lowpass",
    "band_limit",
    "condition_streams",
    "denoise",
    "denoise_causally",
    "design_kaiser",
    "design_lowpass",
    "filtered",
    "level_of_band",
    "measured_band",
]

_HOMES = {
    "kaiser": ("KaiserFilter", "design_kaiser", "filtered"),
    "lowpass": ("Lowpass", "design_lowpass"),
    "streams": ("Change", "condition_streams"),
    "wavelet": ("Denoised", "band_limit", "denoise", "denoise_causally", "level_of_band", "measured_band"),
}


def __getattr__(name: str) -> object:
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"imuwb.conditioning.{module}"), name)
    message = f"module 'imuwb.conditioning' has no attribute {name!r}"
    raise AttributeError(message)


def __dir__() -> list[str]:
    return sorted(__all__)
