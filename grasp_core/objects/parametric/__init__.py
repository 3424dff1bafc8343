"""A catalogue of everyday shapes made from parameters and a seed, one file per family group."""

from grasp_core.objects.parametric import bathroom, food, furniture, machine, office, tools, toys, vessels
from grasp_core.objects.parametric.family import FAMILIES, Family, make

__all__ = [
    "FAMILIES",
    "Family",
    "bathroom",
    "food",
    "furniture",
    "machine",
    "make",
    "office",
    "tools",
    "toys",
    "vessels",
]
