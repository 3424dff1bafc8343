"""A catalogue of everyday shapes made from parameters and a seed, one file per family group."""

from grasp_core.objects.parametric import food, office, tools, vessels
from grasp_core.objects.parametric.family import FAMILIES, Family, make

__all__ = ["FAMILIES", "Family", "food", "make", "office", "tools", "vessels"]
