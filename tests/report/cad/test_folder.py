"""The folder of CAD files: what is in it, what is left out, and what it says of both."""

from __future__ import annotations

import io
import math
import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from evodesign.body.placement import Placement
from evodesign.body.shape import Box
from evodesign.errors import on_one_line
from evodesign.report.cad.folder import cad_files
from evodesign.report.cad.outlines import FRONT, link_outlines
from evodesign.report.cad.parts import parts_of
from evodesign.tree.model import Look
from tests.report.cad.press import HOSTILE, press
from tests.report.cad.reread import measured, parts_in, solids_in

STAMP = "2024-01-01T00:00:00"
FILES = {
    *("README.md", "assembly.step", "drawing.svg", "cover.stl"),
    *(f"{name}.{kind}" for name in ("frame", "ram_rm", "knob") for kind in ("step", "stl")),
}


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    return cad_files(press(), {"frame": "aluminium_6061"}, "a press", STAMP)


@pytest.fixture(scope="module")
def readme(files: dict[str, bytes]) -> str:
    return files["README.md"].decode()


def test_links_have_files_of_plain_names_and_their_own_names_in_step(files: dict[str, bytes]) -> None:
    assert set(files) == FILES
    names = set(parts_in(files["assembly.step"]))
    assert names == {"frame", on_one_line(HOSTILE), "knob", "motor_turn", "axis_slide", "axis_turn"}


def test_equal_robots_give_equal_files(files: dict[str, bytes]) -> None:
    again = cad_files(press(), {"frame": "aluminium_6061"}, "a press", STAMP)
    assert [name for name in files if files[name] != again[name]] == []


def test_solids_that_overlap_stay_bodies_of_one_product_and_the_readme_says_how_much(
    files: dict[str, bytes], readme: str
) -> None:
    """Both count in the mass model; what they share are walls that cross: four strips, by hand."""
    ((name, part),) = parts_in(files["frame.step"]).items()
    assert (name, len(solids_in(part.body))) == ("frame", 2)
    solids = press().link_by_name["frame"].solids
    volume, *_ = measured(part.body)
    by_hand = sum((float(each.mass) - each.filling) / each.density for each in solids)
    assert volume == pytest.approx(by_hand, rel=1e-9)
    first, second = (trimesh.creation.box(each.shape.sides) for each in solids)
    second.apply_translation(solids[1].link_from_solid.translation)
    hollows = [trimesh.creation.box(each.shape.inside(0.004).sides) for each in solids]
    hollows[1].apply_translation(solids[1].link_from_solid.translation)
    shared = first.difference(hollows[0]).intersection(second.difference(hollows[1])).volume
    assert shared > 0.0
    assert f"`frame` ({100.0 * shared / volume:.2f} %)" in readme


def test_a_mesh_is_written_as_triangles_in_millimetres_and_what_has_no_shape_is_named(
    files: dict[str, bytes], readme: str
) -> None:
    cover = trimesh.load(io.BytesIO(files["cover.stl"]), file_type="stl")
    np.testing.assert_allclose(cover.bounds, [[-50.0] * 3, [50.0] * 3], atol=1e-3)
    assert "an STL and no STEP of them: `cover` (`cover.stl`)." in readme
    assert "no shape, so they are left out: `bolt`." in readme
    assert "`tip`" not in readme


def test_a_link_whose_shapes_do_not_make_its_mass_is_written_and_drawn_as_they_are_seen() -> None:
    seen = Look(Box(0.02, 0.04, 0.06), Placement(translation=(0.0, 0.0, 0.9)))
    tree = press()
    links = [replace(link, looks=(seen,)) if link.name == "bolt" else link for link in tree.links]
    shown = replace(tree, links=tuple(links))
    files = cad_files(shown, {}, "a press", STAMP)
    bolt = trimesh.load(io.BytesIO(files["bolt.stl"]), file_type="stl")
    np.testing.assert_allclose(bolt.bounds, [[-10.0, -20.0, 870.0], [10.0, 20.0, 930.0]], atol=1e-3)
    text = files["README.md"].decode()
    assert "an STL and no STEP of them: `cover` (`cover.stl`), `bolt` (`bolt.stl`)." in text
    assert "left out" not in text
    outlines = {outline.name: outline for outline in link_outlines(parts_of(shown, {}), FRONT)}
    assert outlines["bolt"].corners[:, 1].max() == pytest.approx(0.93)


def test_names_are_text_in_the_readme(readme: str) -> None:
    assert "| `../ram \\| 'rm'\\n` | `ram_rm` | Ø80 x 300 | full |" in readme
    rows = [line for line in readme.splitlines() if line.startswith("|")]
    assert {len(re.split(r"(?<!\\)\|", row)) - 2 for row in rows} == {12, 7, 6, 8, 3}


def test_a_motor_of_the_catalogue_is_named_with_what_it_cuts(readme: str) -> None:
    """Of a full cylinder, the part of the housing within it, by trimesh."""
    (motor,) = [joint.actuator for joint in press().joints if joint.actuator]
    diameter, length = motor.size
    housing = trimesh.creation.cylinder(diameter / 2.0, length, sections=720)
    housing.apply_transform(trimesh.geometry.align_vectors([0.0, 0.0, 1.0], [0.6, 0.0, 0.8]))
    ram = trimesh.creation.cylinder(0.04, 0.3, sections=720)
    ram.apply_translation([0.0, 0.0, -0.19])
    cut = 1e6 * housing.intersection(ram).volume
    row = next(line for line in readme.splitlines() if line.startswith("| `motor_turn` | `X6-60` |"))
    found = float(re.search(r"rm'\\n` ([\d.]+)", row)[1])
    assert cut > 0.4
    assert found == pytest.approx(cut, abs=0.006)


def test_links_that_pass_through_each_other_are_named(readme: str) -> None:
    """A cap of 10 mm of the knob is in the ram, pi h^2 (3 r - h) / 3; frame and ram only touch."""
    shared = math.pi * 0.01**2 * (3.0 * 0.05 - 0.01) / 3.0
    table = readme.partition("## Links that pass through each other")[2].strip().splitlines()
    assert table[2:] == [f"| `knob` | `../ram \\| 'rm'\\n` | {1e6 * shared:.1f} |"]
