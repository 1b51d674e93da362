"""`evodesign export --cad` on the golden run: the folder, and the sentence without the extra."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib import util
from pathlib import Path

import pinocchio
import pytest

import evodesign
from evodesign.cli.main import app
from evodesign.errors import InputError

RUN = Path(__file__).parents[1] / "golden" / "lifting" / "format-2"
SENTENCE = r"--cad: wanted Open CASCADE installed \(pip install 'evodesign\[cad\]'\), found no package 'OCP'"


@pytest.mark.slow
def test_a_design_of_a_run_is_exported_with_cad_files_that_its_readme_explains(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    app(["export", str(RUN), "1", "--to", str(tmp_path / "design"), "--cad"], standalone_mode=False)
    told = {Path(line).relative_to(tmp_path / "design") for line in capsys.readouterr().out.split()}
    cad = {path.name for path in told if path.parent.name == "cad"}
    model = pinocchio.buildModelFromUrdf(str(tmp_path / "design" / "robot.urdf"))
    assert {"README.md", "assembly.step", "drawing.svg", "chest.step", "chest.stl"} < cad
    bodies = {name.removesuffix(".step") for name in cad if name.endswith(".step")} - {"assembly"}
    assert bodies <= {frame.name for frame in model.frames}
    assert len(bodies) == 42
    assert "- `cad`: The robot for CAD programs" in (tmp_path / "design" / "README.md").read_text()
    readme = (tmp_path / "design" / "cad" / "README.md").read_text()
    assert re.search(r"^Largest differences: mass 0\.000 %", readme, re.MULTILINE)
    header = (tmp_path / "design" / "cad" / "chest.step").read_text()[:400]
    assert evodesign.open_run(RUN).log.header.started in header


def test_without_open_cascade_a_sentence_says_what_to_install_before_anything_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("evodesign.report.export.folder.find_spec", lambda name: None)
    assert util.find_spec("OCP") is not None
    with pytest.raises(InputError, match=SENTENCE):
        app(["export", "no/run", "1", "--to", str(tmp_path / "new"), "--cad"], standalone_mode=False)
    with pytest.raises(InputError, match=SENTENCE):
        evodesign.open_run(RUN).design(1).export(tmp_path / "new", cad=True)
    assert not (tmp_path / "new").exists()


def exported(to: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """What the command does in a process that has no Open CASCADE."""
    code = (
        "import sys; sys.modules['OCP'] = None\n"
        "from importlib import util\n"
        "find = util.find_spec\n"
        "util.find_spec = lambda name, *more: None if name == 'OCP' else find(name, *more)\n"
        f"sys.argv[1:] = ['export', {str(RUN)!r}, '1', '--to', {str(to)!r}, *{options!r}]\n"
        "from evodesign.__main__ import main\n"
        "main()\n"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)


def test_without_open_cascade_the_exit_code_is_two(tmp_path: Path) -> None:
    done = exported(tmp_path / "new", "--cad")
    assert done.returncode == 2
    assert re.search(SENTENCE, done.stderr)
    assert not (tmp_path / "new").exists()


@pytest.mark.slow
def test_an_export_without_cad_files_needs_no_open_cascade(tmp_path: Path) -> None:
    done = exported(tmp_path / "new")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "new" / "robot.urdf").exists()
    assert not (tmp_path / "new" / "cad").exists()
