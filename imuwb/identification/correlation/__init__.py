"""Autocorrelation and autoregressive models."""
