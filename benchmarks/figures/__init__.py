"""The figures of ``benchmarks/house.py``, a module for each sort. None of them imports the code that it measures."""
