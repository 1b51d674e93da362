"""The page of a running search: only this machine gets it, and it shows the log's numbers and names."""

from __future__ import annotations

import http.client
import json
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from evodesign.analysis.front import front
from evodesign.errors import InputError, RunError
from evodesign.evolve import resume, start
from evodesign.report.live.server import ADDRESS, LiveServer
from evodesign.report.live.state import FollowedRun, LiveRun, state_of
from evodesign.runlog.session_log import Silent
from tests.faults.synthetic import synthetic_header
from tests.machine import chromium
from tests.runlog.toys import OrderedPool, ToyTask, toy_evaluations, toy_generation, toy_header

NAME = "<script>alert(1)</script>"
HEADER = msgspec.structs.replace(toy_header(budget=100), problem_name=NAME)
RUN = toy_evaluations(HEADER, 40)
CHROMIUM = chromium()
LIVE = synthetic_header(budget=10, seed=4, population=10)


def state(*, ended: bool = False, now: float = 45.0, count: int = len(RUN)) -> dict[str, object]:
    watched = LiveRun()
    records = [HEADER, *RUN[:count], toy_generation(0, 4), toy_generation(1, 8)]
    watched.learn([(record, float(second)) for second, record in enumerate(records)])
    assert watched.state is not None
    return state_of(watched.state, ended=ended, now=now, notes=["missing: <b>all</b>"])


@pytest.fixture
def server() -> Iterator[LiveServer]:
    with LiveServer(0, lambda: json.dumps(state()).encode()) as served:
        thread = threading.Thread(target=served.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield served
        served.shutdown()
        thread.join()


def get(server: LiveServer, path: str, host: str = "127.0.0.1") -> tuple[int, str]:
    connection = http.client.HTTPConnection(ADDRESS, server.server_port, timeout=60)
    connection.request("GET", path, headers={"Host": f"{host}:{server.server_port}"})
    answer = connection.getresponse()
    content = answer.read().decode()
    connection.close()
    return answer.status, content


def test_state_holds_the_log_s_numbers() -> None:
    found = state()
    best = front(HEADER.objectives, RUN)
    torques = [each.assessment.objectives["robot_torque"] for each in best]
    assert found["done"] == len(RUN)
    assert found["front_size"] == len(best)
    assert [point[1] for point in found["front"]] == torques  # type: ignore[attr-defined]
    assert found["objectives"][0]["best"] == min(torques)  # type: ignore[index]
    assert found["failures"] == {"infeasible": sum(not each.feasible for each in RUN)}


@pytest.mark.parametrize(
    ("ended", "now", "count", "word"),
    [(False, 45.0, 40, "running"), (False, 200.0, 40, "silent"), (True, 45.0, 40, "stopped")],
)
def test_state_in_a_word(ended: bool, now: float, count: int, word: str) -> None:
    assert state(ended=ended, now=now, count=count)["state"] == word


def test_nothing_evaluated_yet_has_a_state() -> None:
    found = state(count=0)
    assert (found["done"], found["front"], found["knees"], found["per_second"]) == (0, [], [], None)


def test_what_a_run_has_lost_is_part_of_its_state(tmp_path: Path) -> None:
    start(tmp_path / "run", LIVE, ToyTask(LIVE), OrderedPool(), Silent())
    assert FollowedRun(tmp_path / "run").state()["notes"] == []
    resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), 20)
    resume(tmp_path / "run", ToyTask, OrderedPool(), Silent(), 30)
    followed = FollowedRun(tmp_path / "run")
    assert followed.state()["notes"] == []
    (tmp_path / "run/001.mcap").unlink()
    notes = FollowedRun(tmp_path / "run").state()["notes"]
    assert "segment 1 of the run is missing" in notes
    assert "missing evaluations: 10 to 19" in notes


def test_server_answers_two_paths(server: LiveServer) -> None:
    assert server.server_address[0] == "127.0.0.1"
    assert get(server, "/")[0] == 200
    assert json.loads(get(server, "/state.json")[1])["problem"] == NAME
    assert get(server, "/../../etc/passwd")[0] == 404


def test_request_by_another_name_is_refused(server: LiveServer) -> None:
    assert get(server, "/state.json", host="evil.example")[0] == 403
    assert get(server, "/state.json", host="localhost")[0] == 200


def test_page_fetches_nothing_from_elsewhere(server: LiveServer) -> None:
    page = get(server, "/")[1]
    without_svg_names = page.replace('"http://www.w3.org/2000/svg"', "")
    assert "http" not in without_svg_names
    assert "src=" not in page


def test_run_that_has_gone_is_said_without_a_traceback(capsys: pytest.CaptureFixture[str]) -> None:
    def gone() -> bytes:
        raise RunError("runs/first: there is no such run directory")

    with LiveServer(0, gone) as served:
        thread = threading.Thread(target=served.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        assert get(served, "/state.json") == (503, "runs/first: there is no such run directory")
        served.shutdown()
        thread.join()
    assert "Traceback" not in capsys.readouterr().err


def test_port_that_is_taken_is_named(server: LiveServer) -> None:
    with pytest.raises(InputError, match="--port: wanted a free port"):
        LiveServer(server.server_port, lambda: b"")


@pytest.mark.needs_chromium
def test_browser_shows_names_as_text(server: LiveServer, tmp_path: Path) -> None:
    flags = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-background-networking",
        "--no-first-run",
    ]
    silent = ["--disable-component-update", "--disable-sync", f"--user-data-dir={tmp_path}"]
    command = [str(CHROMIUM), *flags, *silent, "--virtual-time-budget=4000", "--dump-dom", server.url]
    page = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "40 of 100 evaluations" in page
    assert "<li>missing: &lt;b&gt;all&lt;/b&gt;</li>" in page
    assert page.count('class="front"') >= len(front(HEADER.objectives, RUN))
