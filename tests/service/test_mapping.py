"""A short drive through the simulated landing: all services, three mappers, maps and their scores."""

import pytest
from PIL import Image

from tests.service.test_demo import experiments, rows


def cells(text):
    """A table's numbers without their units."""
    return float(text.split()[0])


@pytest.mark.slow
@pytest.mark.parametrize("keys", [[], ["--secure"]], ids=["one router", "keys, two routers"])
def test_a_drive_is_mapped_from_three_scans_and_scored(tmp_path, keys):
    done = experiments("--map", "--route", "0.3,0", *keys, "--out", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 bumps" in done.stdout
    assert "not reached" not in done.stdout
    table = {name.split(",")[0]: list(map(cells, numbers)) for name, *numbers in rows(tmp_path / "maps.md")}
    positive, paper, fused = (table[name] for name in ("positive", "the paper's", "fused (ours)"))
    assert positive[0] > 1.0  # [m²] free beyond the stairs: figure 24
    assert fused[0] < min(0.5, positive[0] / 3)
    assert fused[2] > 90.0 > 20.0 > positive[2]  # [%] of the edges
    for name, numbers in table.items():
        assert numbers[1] < 0.5, name  # [m²] blocked wrongly
        assert numbers[3] < 5.0, name  # [cm] the pose's error
    assert paper[0] < positive[0]
    for name in ("positive", "paper", "fused"):
        assert (tmp_path / f"map_{name}" / "map.yaml").is_file()
    with Image.open(tmp_path / "maps.png") as picture:
        assert min(picture.size) > 400
