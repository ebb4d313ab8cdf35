"""What is done to samples before they are analysed or navigated with: arrays in, arrays out."""

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
