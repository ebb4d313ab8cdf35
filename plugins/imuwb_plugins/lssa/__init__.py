"""Least-squares spectrum: periodic lines of unevenly spaced, coloured series with intervals, and tests of the noise.

Vanicek's spectrum with known constituents estimated together with every line, significance at one frequency and in the whole
record, and tests whether the noise is a random walk or autoregressive (Pagiatakis; El-Diasty and others).

Example: imuwb lssa static.mcap --noise ar:2 --highest 5
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={"parameters": ["Parameters"], "compute": ["findings", "run"], "show": ["draw"], "answer": ["answer"]},
)
