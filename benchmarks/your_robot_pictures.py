"""The pictures of docs/your_robot.md, to be drawn again when the page of a run looks different.

    python -m benchmarks.your_robot_pictures [RUN]

The robot is Unitree's G1 as example-robot-data packs it (BSD-3-Clause). Without RUN it is guessed and
searched by the page's commands, which takes some minutes. Chromium is needed.
"""

from __future__ import annotations

import base64
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from tests.report.page.chromium import Tab, browser
from tests.report.page.reading import open_page
from tests.robots import HUMANOIDS

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
COMMAND = [sys.executable, "-m", "evodesign"]
MARKS = ("least robot torque", "least human torque")
SHOWN = (0.22, 0.11, 0.56, 0.83)
"""Left, top, width and height of the part of the posture's canvas that holds robot and person [share]."""
LARGEST = 150_000
"""Size of a picture's file [byte]."""


def search(folder: Path) -> Path:
    """The run of the page's commands."""
    urdf = HUMANOIDS["g1"]
    for arguments in (
        ["init", str(urdf), "--to", "g1.toml"],
        ["search", "g1.toml", "--evaluations", "240", "--run", "run"],
    ):
        subprocess.run([*COMMAND, *arguments], cwd=folder, check=True)
    return folder / "run"


def part_of(tab: Tab, box: tuple[float, float, float, float]) -> Image.Image:
    """Part of the page: left, top, width and height in the window."""
    clip = dict(zip(("x", "y", "width", "height"), box, strict=True))
    clip["y"] += tab.value("window.scrollY")
    answer = tab.call("Page.captureScreenshot", format="png", clip={**clip, "scale": 1})
    return Image.open(BytesIO(base64.b64decode(answer["data"]))).convert("RGB")


def choose(tab: Tab, mark: str) -> None:
    """Show the design of a mark at the greatest height."""
    number = tab.value(f"evodesign.content.marks.find(({{label}}) => label === {mark!r}).number")
    tab.value(f"evodesign.select({number}, {{announce: false}})")
    tab.value("evodesign.showCase(0, 0, evodesign.content.heights_m.length - 1)")


def postures(tab: Tab) -> Image.Image:
    """The marked designs side by side, twice as fine as the window."""
    tab.call("Emulation.setDeviceMetricsOverride", width=1440, height=920, deviceScaleFactor=2, mobile=False)
    seen = []
    for mark in MARKS:
        choose(tab, mark)
        left, top, width, height = tab.place("document.getElementById('posture')")
        x, y, w, h = SHOWN
        seen.append(part_of(tab, (left + x * width, top + y * height, w * width, h * height)))
    whole = Image.new("RGB", (sum(each.width for each in seen), seen[0].height))
    for place, each in enumerate(seen):
        whole.paste(each, (place * each.width, 0))
    return whole


def write(picture: Image.Image, name: str, largest: int = LARGEST) -> None:
    """Write a picture in its 256 best colours, small enough for a page."""
    path = PICTURES / name
    picture.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=8, dither=Image.Dither.NONE).save(
        path, optimize=True
    )
    print(path, path.stat().st_size)
    assert path.stat().st_size < largest, f"{path} is too large"


def main(run: Path) -> None:
    """Write the page of a run, and what it shows."""
    with TemporaryDirectory() as name, browser(Path(name) / "profile") as tab:
        page = Path(name) / "report.html"
        subprocess.run([*COMMAND, "report", str(run), "--output", str(page)], check=True)
        open_page(tab, page)
        choose(tab, MARKS[1])
        write(part_of(tab, (0, 0, 1440, 920)), "your_robot_front.png")
        write(postures(tab), "your_robot_postures.png")


if __name__ == "__main__":
    if sys.argv[1:]:
        main(Path(sys.argv[1]).resolve())
    else:
        with TemporaryDirectory() as folder:
            main(search(Path(folder)))
