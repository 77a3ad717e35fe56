"""Where results go; one file per format."""
