"""The page: the answer, figures, tables and notes of an analysis in one self-contained HTML file."""
