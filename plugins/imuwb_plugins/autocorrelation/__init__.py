"""Autocorrelation, before and after denoising, and a test for a first-order Gauss-Markov process.

By fast Fourier transform, normalised, with the band that white noise stays in. The likeliest Gauss-Markov process (sigma, Tc) is
fitted and tested. Denoising shows the slow processes that white noise hides.

Example: imuwb autocorrelation static.mcap --longest 600
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={"parameters": ["Parameters"], "compute": ["findings", "run"], "show": ["draw"], "answer": ["answer"]},
)
