"""Studies of real recordings, diagnosed in one process each."""
