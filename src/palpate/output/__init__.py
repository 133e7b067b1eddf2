"""What people look at: figures, pages, and files for other programs."""
