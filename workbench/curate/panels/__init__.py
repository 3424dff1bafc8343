"""What the curation shows, panel by panel."""
