"""POMDP benchmark problems built from formulas, and written as `.pomdp` and `.pomdpx`."""
