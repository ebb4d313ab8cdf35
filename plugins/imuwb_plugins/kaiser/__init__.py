"""Kaiser low-pass: linear phase, from the edges of its bands or from its cutoff and width."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"parameters": ["ORDER", "Parameters"], "apply": ["condition", "draw"]}
)
