"""Tables and arrays: Parquet, Feather, MATLAB, NumPy, MDF4, and the binary tables of programs for navigation."""
