"""What KR3's Python programs share."""
