"""Draws the pictures of a run's page, of README and docs/page.md: `python -m docs.write_front RUN`.

RUN is a search of the default problem. `front.png` is the front of its page, with the robots of some marked
designs beside it, `report_front.png` the page's upper part, `report_brush.png` a choice of designs in the
dark. Chromium is needed.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import quote

from PIL import Image

from benchmarks.your_robot_pictures import COMMAND, choose, part_of, write
from tests.report.page.chromium import Tab, browser
from tests.report.page.reading import open_page

MARKS = ("least robot torque", "knee", "least human torque")
SHOWN = (0.2, 0.02, 0.6, 0.97)
"""Left, top, width and height of the part of the posture's canvas that holds robot and person [share]."""

WITHOUT_BUTTONS = """
[...document.querySelectorAll('#card button')]
  .filter((button) => ['Oblique', 'Side', "Robot's front", "Person's front"].includes(button.textContent))
  .forEach((button) => (button.style.visibility = 'hidden'));
"""
"""Hides what stands before the tallest robots."""


def draw(tab: Tab) -> Image.Image:
    """The front, and under it the robots side by side."""
    tab.call("Emulation.setDeviceMetricsOverride", width=1240, height=900, deviceScaleFactor=1, mobile=False)
    tab.value("document.getElementById('front').scrollIntoView()")
    front = part_of(tab, tab.place("document.getElementById('front')"))
    robots = []
    for mark in MARKS:
        choose(tab, mark)
        tab.value(WITHOUT_BUTTONS)
        left, top, width, height = tab.place("document.getElementById('posture')")
        x, y, w, h = SHOWN
        robots.append(part_of(tab, (left + x * width, top + y * height, w * width, h * height)))
    across = max(front.width, sum(each.width for each in robots))
    whole = Image.new("RGB", (across, front.height + robots[0].height), "white")
    whole.paste(front, (0, 0))
    for place, each in enumerate(robots):
        whole.paste(each, (place * across // len(robots), front.height))
    return whole


WINDOW = 1440, 860
KEPT = "keep=0 38 robot_torque&keep=1.6 3 shared_reach_height"
"""The brushes of the picture, as a link to the page has them."""


def scrolled(tab: Tab, to: str) -> Image.Image:
    """What a window shows with a section at its top."""
    width, height = WINDOW
    tab.call(
        "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False
    )
    tab.value(f"document.getElementById('{to}').closest('section').scrollIntoView()")
    return part_of(tab, (0, 0, width, height))


def main(run: Path) -> None:
    """Write the page of a run, and what it shows."""
    with TemporaryDirectory() as name, browser(Path(name) / "profile") as tab:
        page = Path(name) / "report.html"
        subprocess.run([*COMMAND, "report", str(run), "--output", str(page)], check=True)
        open_page(tab, page)
        choose(tab, MARKS[0])
        write(draw(tab), "front.png")
        open_page(tab, page)
        choose(tab, MARKS[1])
        write(scrolled(tab, "front-title"), "report_front.png")
        tab.open(f"{page.as_uri()}#{quote(KEPT, safe='=&')}", theme="dark")
        tab.wait_for("window.evodesign !== undefined")
        write(scrolled(tab, "parallel-title"), "report_brush.png", 200_000)  # hundreds of lines


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
