"""Power spectral density: N, B, K, Q with intervals, periodic lines, slopes.

Welch's method with segments of up to 2^20 samples, averaged over bands of frequency, and the sum of processes that fits by
likelihood. Densities are one-sided.

Example: imuwb psd run.mcap --start 60 --end 7200
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={"parameters": ["Parameters"], "compute": ["findings", "run"], "show": ["draw"], "answer": ["answer"]},
)
