"""Specs: what is written, loaded and checked; and the cases they become."""
