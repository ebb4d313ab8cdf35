"""Power spectral densities and their periodic lines."""
