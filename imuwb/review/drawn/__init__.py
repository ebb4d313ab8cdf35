"""What an analysis has drawn, as frozen values: checked, made shorter, and standing still for a page."""
