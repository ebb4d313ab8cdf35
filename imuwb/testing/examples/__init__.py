"""Complete plugins, one of each kind, with their tests: ``imuwb plugins new`` writes them under another name."""
