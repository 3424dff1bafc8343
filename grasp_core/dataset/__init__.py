"""The dataset: store, generation, labels, review and foreign formats."""
