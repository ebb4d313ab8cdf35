"""Figures in the viewer: axes, curves, bands, bars and legends as lines and labels of a 2D view."""
