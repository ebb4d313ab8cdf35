"""El-Diasty, El-Rabbany and Pagiatakis: noise of two IMUs at chamber temperatures, before and after a low-pass."""
