"""Autoregressive models of all orders by Burg's method, with standard errors and poles.

x(n) = -sum alpha_k x(n-k) + beta0 w(n). Orders are compared by AICc, BIC and FPE, coefficients are tested at 99 %, and innovations
are tested for whiteness. Give --through wavelet:levels=6 to model the denoised samples, as the papers do.

Example: imuwb autoregressive static.mcap --through wavelet:levels=6 --save-model ar.toml
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "parameters": ["Parameters"],
        "compute": ["error_model", "findings", "objections", "run"],
        "show": ["draw"],
        "answer": ["answer"],
    },
)
