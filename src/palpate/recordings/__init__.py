"""What was measured: recordings, contact point, segments and drift, and the files of instruments."""
