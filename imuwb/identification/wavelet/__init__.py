"""The variance of wavelet coefficients, scale by scale, and the sum of processes that explains it."""
