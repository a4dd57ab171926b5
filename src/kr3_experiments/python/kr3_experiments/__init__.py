"""Bring-up, demo and command line of KR3."""
