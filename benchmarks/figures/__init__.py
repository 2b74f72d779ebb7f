"""Figures for ``benchmarks/house.py``, with one module for each kind. No module imports the code that it measures."""
