from grasp_core.lettering import plain


def test_signs_are_spelled_out_and_the_unknown_is_marked():
    assert plain("turned by 48°, 3 × 4 mm, φ → 0") == "turned by 48 deg, 3 x 4 mm, phi -> 0"
    assert plain("plain words") == "plain words"
    assert plain("名") == "?"
