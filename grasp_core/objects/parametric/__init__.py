"""A catalogue of everyday shapes made from parameters and a seed, one file per family group."""
