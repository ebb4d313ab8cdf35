"""Wavelet denoising: SURE, universal or Bayes thresholds, of the whole record or in a sliding window.

A threshold is in units of the noise. scale=level estimates the noise of each level from its details (MATLAB: mln), scale=first that of
the finest level for all (sln): what is larger than the noise stays. scale=none takes 1 SI unit (one): every detail of a still record is
smaller and is removed, which leaves a low-pass of rate / 2^(levels + 1). Quinchia's table 2 was made so. An autoregressive process of
such samples is a property of that low-pass rather than of the sensor: its poles are those of the filter.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "Parameters"], "apply": ["condition", "draw"]}
)
