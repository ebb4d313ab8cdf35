"""Power spectral densities and the lines in them."""
