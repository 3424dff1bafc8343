"""Objects: assets, the parametric catalogue, importers and convex decomposition."""
