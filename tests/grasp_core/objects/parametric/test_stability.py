"""The catalogue must not change: datasets and splits name its objects. A change of shape needs a new family name."""

import hashlib
import json
from pathlib import Path

from grasp_core.objects.parametric import FAMILIES, make

FILE = Path(__file__).with_name("catalogue_hashes.json")


def fingerprint(name: str) -> str:
    """A hash of sizes, volumes and counts of two objects, coarse enough for other machines' last digits."""
    h = hashlib.sha256()
    for seed in (0, 7):
        asset = make(name, seed)
        sides = [f"{side:.4e}" for side in (*asset.extents, asset.mesh.volume, asset.volume, asset.hull.volume)]
        h.update(" ".join([*sides, str(len(asset.parts))]).encode())
    return h.hexdigest()[:12]


def test_every_family_still_makes_the_same_objects():
    held = json.loads(FILE.read_text())
    assert set(held) == set(FAMILIES), "add new families to catalogue_hashes.json, never remove one"
    changed = [name for name in sorted(FAMILIES) if fingerprint(name) != held[name]]
    assert not changed, f"these families make other objects than before: {', '.join(changed)}"
