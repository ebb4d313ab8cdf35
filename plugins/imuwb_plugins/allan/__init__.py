"""Allan deviation: noise coefficients Q, N, B, K, R with intervals.

Overlapping Allan deviation of all axes with intervals, one fit of the whole sum of processes, and the slope of a free line where
each process dominates. Likelihood and wavelet variances give estimates for comparison.

Example: imuwb allan static.mcap --imu /imu/data -o allan.rrd
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "parameters": ["Parameters"], "compute": ["error_model", "objections", "run"], "remarks": ["findings"], "show": ["draw"],
        "answer": ["answer"],
        "imus": ["compare_imus", "draw_imus"], "imus_answer": ["answer_imus"],
    },
)  # fmt: skip
