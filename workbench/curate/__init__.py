"""The curation: samples of a dataset, what physics, networks and people say of them, and decisions about them."""
