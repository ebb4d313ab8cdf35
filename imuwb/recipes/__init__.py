"""What runs several analyses: recipes of their names, which lay side by side what they find."""
