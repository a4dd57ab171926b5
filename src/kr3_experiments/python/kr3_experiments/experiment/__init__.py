"""Experiments: sweeps of trials, their rows, statistics, figures and reports."""
