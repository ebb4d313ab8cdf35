"""Text logs: separated numbers in any layout, and RTKLIB solutions."""
