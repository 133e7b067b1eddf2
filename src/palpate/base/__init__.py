"""What every package uses: parameters with their bounds, files in YAML, hashes of content and code."""
