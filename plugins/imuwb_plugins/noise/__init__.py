"""Noise of a still IMU: all noise analyses together, one recording, one error model.

Allan deviation, likelihood, wavelet variance, spectrum, autocorrelation and autoregressive models of one log, side by side, with a
verdict for each axis. Several logs of one sensor are compared: which coefficients differ, and how much the bias changes from one
turn-on to the next. --study repeats the analysis after conditioners.

Example: imuwb noise static.mcap --html static.html
"""

import lazy_loader

LOGS = (1, None)
LEAVES_MODEL = True
DEMO = "still"

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "parameters": ["Parameters"],
        "compute": ["compare_imus", "run"],
        "answer": ["answer", "answer_imus", "answer_study", "findings"],
        "show": ["draw", "draw_imus"],
        "model": ["error_model", "objections"],
        "settings": ["study"],
        "show_settings": ["draw_study"],
    },
)
