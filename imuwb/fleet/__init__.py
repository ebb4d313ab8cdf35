"""A fleet of logs: the same analysis of many logs, and the tables of what it finds."""
