"""Compare the texts of two editions of a manual, and find the facts that cite the passages that changed."""
