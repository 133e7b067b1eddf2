"""What recordings say about parameters: their coordinates and prior, and least squares on the finite elements."""
