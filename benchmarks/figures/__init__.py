"""Figures of ``benchmarks/house.py``, one module for each sort. None of them imports the code that it measures."""
