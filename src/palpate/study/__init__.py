"""What is asked of a specimen: load history, indenter and body, put together as one specification."""
