"""Text logs: separated numbers of any layout, and RTKLIB solutions."""
