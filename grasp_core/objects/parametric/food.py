"""Fruit, vegetables and baked goods."""

from __future__ import annotations

import math

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.solids import Solid, curve, tube


@family("fruit", 12, 20)
def banana(rng: np.random.Generator) -> Solid:
    """A bent fruit, thick in the middle, with a stem."""
    bend, length, thick = rng.uniform(0.6, 1.6), 16.0, rng.uniform(1.4, 2.1)
    t = np.linspace(-0.5, 0.5, 25)
    radius = length / bend
    path = np.c_[radius * np.sin(bend * t), np.zeros(25), radius * (1 - np.cos(bend * t))]
    s = np.linspace(0, 1, 25)
    body = np.clip(np.sin(np.pi * (0.06 + 0.9 * s)) ** 0.55, 0.22, 1)
    body[:3] = [0.3, 0.3, 0.42]
    return tube(path, thick * body, rng.uniform(0.85, 1.05), pieces=7, n=rng.uniform(2, 2.6), up=(0, 1, 0))


@family("food", 7, 14)
def donut(rng: np.random.Generator) -> Solid:
    """A ring; the hole small to wide."""
    ring, thick = 4.0, rng.uniform(1.0, 2.6)
    t = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    return tube(np.c_[ring * np.cos(t), ring * np.sin(t), 0 * t], thick, rng.uniform(0.75, 1.1), pieces=12, closed=True)


@family("food", 10, 17)
def croissant(rng: np.random.Generator) -> Solid:
    """A crescent, thick in the middle."""
    bend = rng.uniform(1.6, 2.8)
    t = np.linspace(-0.5, 0.5, 25)
    path = curve(np.c_[10 / bend * np.sin(bend * t), 10 / bend * (1 - np.cos(bend * t)), 0 * t], 25)
    body = 0.35 + np.cos(np.pi * t) ** 0.8 * (1 + 0.06 * np.sign(np.sin(22 * t)))
    return tube(path, body * rng.uniform(1.5, 2.1), rng.uniform(0.75, 1.0), pieces=6)
