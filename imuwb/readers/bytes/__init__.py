"""Files as bytes, and bytes as arrays: opening, unpacking, and reading numbers from buffers."""
