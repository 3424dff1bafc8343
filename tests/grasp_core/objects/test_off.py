import numpy as np
import pytest

from grasp_core.errors import MeshError
from grasp_core.objects.off import read_off

SQUARE = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"


@pytest.mark.parametrize(
    "text",
    [
        "OFF\n4 2 0\n" + SQUARE + "3 0 1 2\n3 0 2 3\n",
        "OFF4 2 0\n" + SQUARE + "3 0 1 2\n3 0 2 3\n",
        "OFF\r\n4 2 0\r\n" + SQUARE.replace("\n", "\r\n") + "3 0 1 2\r\n3 0 2 3\r\n",
        "OFF # a comment\n\n4 1 0\n" + SQUARE + "4 0 1 2 3\n",
        "COFF\n4 2 0\n" + SQUARE.replace("\n", " 255 0 0 255\n") + "3 0 1 2 255 0 0\n3 0 2 3\n",
        "off\n4 2\n" + SQUARE + "3 0 1 2\n3 0 2 3",
    ],
)
def test_dialects_read_alike(tmp_path, text):
    file = tmp_path / "a.off"
    file.write_bytes(text.encode())
    mesh = read_off(file)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert np.allclose(mesh.vertices, [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("solid x", "does not begin with OFF"),
        ("", "does not begin with OFF"),
        ("OFF BINARY\n", "binary OFF"),
        ("OFF\nmany faces 0\n", "counts of vertices"),
        ("OFF\n4 2 0\n" + SQUARE, "promises 4 vertices and 2 faces but ends after 4 lines"),
        ("OFF\n4 1 0\n" + SQUARE + "3 0 1 9\n", "names vertex 9 of 4"),
        ("OFF\n4 1 0\n" + SQUARE.replace("1 1 0", "1 one 0") + "3 0 1 2\n", "damaged"),
        ("OFF\n4 1 0\n" + SQUARE + "4 0 1 2\n", "damaged"),
    ],
)
def test_bad_files_are_refused_by_name_with_the_reason(tmp_path, text, says):
    file = tmp_path / "bad.off"
    file.write_text(text)
    with pytest.raises(MeshError, match=says) as caught:
        read_off(file)
    assert "bad.off" in str(caught.value)
