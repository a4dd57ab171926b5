"""Experiments: sweeps of trials, their rows, statistics, figures and reports (DESIGN.md, section 9)."""
