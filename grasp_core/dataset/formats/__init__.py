"""Readers of foreign dataset formats."""
