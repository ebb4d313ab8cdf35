"""The fixes of a receiver: what is left out, made worse, or refused."""
