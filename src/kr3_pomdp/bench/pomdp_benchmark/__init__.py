"""Measurements of the POMDP solver against its goals, and beside a peer."""
