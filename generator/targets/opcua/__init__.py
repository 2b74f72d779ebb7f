"""Target for OPC UA type plates."""
